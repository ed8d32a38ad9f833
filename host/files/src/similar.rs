//! The known name that is most like a mistyped one.

/// Of these names, the one that a few wrong, missing, added or exchanged letters make of `name`:
/// at most a third of its length, and at least one. None if no name is that near.
pub(crate) fn similar<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let allowed = (name.chars().count() / 3).max(1);
    let near = known
        .into_iter()
        .map(|other| (distance(name, other), other));
    let nearest = near.min_by_key(|(distance, _)| *distance);
    nearest
        .filter(|(distance, _)| (1..=allowed).contains(distance))
        .map(|(_, other)| other)
}

/// "; did you mean `name`?", if a known name is near.
pub fn did_you_mean<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let found = similar(name, known);
    found.map_or_else(String::new, |found| format!("; did you mean `{found}`?"))
}

/// Letters to insert, delete, replace or exchange with their neighbour, in any case (the optimal
/// string alignment distance).
fn distance(a: &str, b: &str) -> usize {
    let letters = |text: &str| -> Vec<char> { text.to_lowercase().chars().collect() };
    let (a, b) = (letters(a), letters(b));
    let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).collect()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = replaced.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::{distance, similar};

    #[test]
    fn distances_count_letters() {
        for (a, b, expected) in [
            ("", "", 0),
            ("", "abc", 3),
            ("benchtop", "Benchtop", 0),
            ("bnechtop", "benchtop", 1),
            ("benchop", "benchtop", 1),
            ("benchttop", "benchtop", 1),
            ("banchtop", "benchtop", 1),
            ("kitten", "sitting", 3),
        ] {
            assert_eq!(distance(a, b), expected, "{a} {b}");
            assert_eq!(distance(b, a), expected, "{b} {a}");
        }
    }

    #[test]
    fn only_near_names_are_found() {
        let known = ["benchtop", "haply", "duet"];
        assert_eq!(similar("benchtpo", known), Some("benchtop"));
        assert_eq!(similar("hapyl", known), Some("haply"));
        for far in ["other", "my-arm.toml", "x"] {
            assert_eq!(similar(far, known), None, "{far}");
        }
    }
}
