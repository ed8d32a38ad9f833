//! What people state and the machine code does not show: bounds of loops, targets of calls.

use core::cell::Cell;

use crate::image::Image;
use crate::longest::Bound;

/// A table of statements; each line is one.
///
/// ```text
/// loop  <bound> <function> #n   ; why
/// total <bound> <function> #n   ; why
/// calls <function> -> <function>, <function>   ; why
/// ends  <function>   ; why
/// rom   <function>   ; why
/// ```
///
/// `rom` names a function whose calls through registers go into the boot ROM, whose code is not in the image.
///
/// `ends` names a function that ends the program, such as a handler: its stack matters, its time does not.
///
/// The bound of `loop` is how often the loop's header is executed at each entry into the loop;
/// that of `total` is how many rounds the loop makes while the function runs. `n` is the loop's
/// number in its function, by address from 1: so another loop in the function has no bound. A
/// name ends in `*` where only its beginning is given.
#[derive(Clone, Debug, Default)]
pub struct Stated {
    loops: Vec<Loop>,
    calls: Vec<Calls>,
    ends: Vec<String>,
    rom: Vec<String>,
}

#[derive(Clone, Debug)]
struct Loop {
    bound: Bound,
    function: String,
    number: usize,
    text: String,
    used: Cell<bool>,
}

#[derive(Clone, Debug)]
struct Calls {
    function: String,
    targets: Vec<String>,
}

/// Whether `name` is the one given, or begins like it.
fn matches(given: &str, name: &str) -> bool {
    match given.strip_suffix('*') {
        Some(beginning) => name.starts_with(beginning),
        None => given == name,
    }
}

impl Stated {
    /// Reads a table; lines that are empty or begin with `#` are skipped.
    ///
    /// # Errors
    /// The first line that is not a statement with a reason.
    pub fn read(text: &str) -> Result<Self, String> {
        let mut stated = Self::default();
        for line in text.lines().map(str::trim) {
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            stated
                .line(line)
                .ok_or_else(|| format!("not a statement with a reason: {line}"))?;
        }
        Ok(stated)
    }

    fn line(&mut self, line: &str) -> Option<()> {
        let (statement, why) = line.split_once(';')?;
        let (kind, rest) = statement.trim().split_once(' ')?;
        if why.trim().is_empty() {
            return None;
        }
        match kind {
            "loop" | "total" => {
                let (times, name) = rest.trim().split_once(' ')?;
                let times = times.parse().ok()?;
                let (function, number) = name.trim().rsplit_once(" #")?;
                self.loops.push(Loop {
                    bound: if kind == "loop" {
                        Bound::EachEntry(times)
                    } else {
                        Bound::InAll(times)
                    },
                    function: function.to_owned(),
                    number: number.parse().ok()?,
                    text: statement.trim().to_owned(),
                    used: Cell::new(false),
                });
            }
            "calls" => {
                let (function, targets) = rest.split_once("->")?;
                let targets = targets.split(", ").map(|target| target.trim().to_owned());
                self.calls.push(Calls {
                    function: function.trim().to_owned(),
                    targets: targets.collect(),
                });
            }
            "ends" => self.ends.push(rest.trim().to_owned()),
            "rom" => self.rom.push(rest.trim().to_owned()),
            _ => return None,
        }
        Some(())
    }

    /// The bound of a function's `number`th loop.
    pub fn bound(&self, function: &str, number: usize) -> Option<Bound> {
        let meant = |it: &&Loop| matches(&it.function, function) && it.number == number;
        let stated = self.loops.iter().find(meant)?;
        stated.used.set(true);
        Some(stated.bound)
    }

    /// The statements on loops that were not asked for: their loops are no longer there.
    pub fn unused(&self) -> impl Iterator<Item = &str> {
        let unused = self.loops.iter().filter(|it| !it.used.get());
        unused.map(|it| it.text.as_str())
    }

    /// Whether a function ends the program.
    pub fn ends(&self, function: &str) -> bool {
        self.ends.iter().any(|given| matches(given, function))
    }

    /// The functions that calls through registers in a function can reach, by their addresses.
    pub fn targets(&self, image: &Image, function: &str) -> Option<Vec<u32>> {
        if self.rom.iter().any(|given| matches(given, function)) {
            return Some(Vec::new());
        }
        let calls = self
            .calls
            .iter()
            .find(|calls| matches(&calls.function, function))?;
        let targets = image.functions().filter(|function| {
            calls
                .targets
                .iter()
                .any(|given| matches(given, &function.name))
        });
        let targets: Vec<u32> = targets.map(|function| function.address).collect();
        (!targets.is_empty()).then_some(targets)
    }
}
