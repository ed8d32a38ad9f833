//! DXF as entities: lines in pairs, a number that says what the value on the next line is.

use crate::budget::Budget;

/// A value and the number of its meaning, its group code.
pub(super) type Group<'a> = (i32, &'a str);

/// What begins with group 0: an entity, a layer, or a mark of the file's structure.
#[derive(Debug)]
pub(super) struct Entity<'a> {
    /// The line of the file, from 1.
    pub(super) line: usize,
    pub(super) kind: &'a str,
    pub(super) groups: Vec<Group<'a>>,
}

impl<'a> Entity<'a> {
    pub(super) fn text(&self, code: i32) -> Option<&'a str> {
        self.groups
            .iter()
            .find(|group| group.0 == code)
            .map(|group| group.1)
    }

    /// The numbers with this code, in order.
    pub(super) fn numbers(&self, code: i32) -> Result<Vec<f64>, String> {
        let groups = self.groups.iter().filter(|group| group.0 == code);
        groups.map(|&(_, value)| self.parsed(code, value)).collect()
    }

    /// The number with this code.
    pub(super) fn number(&self, code: i32) -> Result<Option<f64>, String> {
        let value = self.text(code);
        value.map(|value| self.parsed(code, value)).transpose()
    }

    pub(super) fn needed(&self, code: i32) -> Result<f64, String> {
        self.number(code)?
            .ok_or_else(|| self.wrong(&format!("it has no group {code}")))
    }

    /// A bit field; 0 if there is none.
    pub(super) fn flags(&self, code: i32) -> Result<i64, String> {
        Ok(self.number(code)?.unwrap_or(0.0) as i64)
    }

    pub(super) fn parsed(&self, code: i32, value: &str) -> Result<f64, String> {
        let number = value.parse::<f64>().ok().filter(|it| it.is_finite());
        number.ok_or_else(|| self.wrong(&format!("group {code} is no number")))
    }

    pub(super) fn wrong(&self, why: &str) -> String {
        format!("{} in line {}: {why}", self.kind, self.line)
    }
}

/// The entities of a file.
pub(super) fn entities(text: &str) -> Result<Vec<Entity<'_>>, String> {
    let mut entities: Vec<Entity<'_>> = Vec::new();
    let mut budget = Budget::groups();
    let mut lines = (1..).zip(text.lines().map(str::trim));
    while let Some((line, code)) = lines.next() {
        let value = lines.next();
        if value.is_none() && code.is_empty() {
            break;
        }
        let code: i32 = code
            .parse()
            .map_err(|_| format!("line {line} is no group code"))?;
        let (_, value) =
            value.ok_or_else(|| format!("the file ends behind line {line}: save it again"))?;
        budget.take(1)?;
        match entities.last_mut() {
            _ if code == 0 => entities.push(Entity {
                line,
                kind: value,
                groups: Vec::new(),
            }),
            Some(entity) => entity.groups.push((code, value)),
            // Comments.
            None => {}
        }
    }
    Ok(entities)
}
