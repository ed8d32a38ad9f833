//! `docs/verify/data/hazards.csv` has the hazards and causes of `docs/design/safety.md`, with tests that exist.

use std::fs;
use std::path::{Path, PathBuf};

const DOCUMENT: &str = include_str!("../../../docs/design/safety.md");
const TESTS: &str = include_str!("../../../docs/verify/data/hazards.csv");
/// Where tests are, from the repository's root.
const FOLDERS: [&str; 9] = [
    "kinematics",
    "design",
    "firmware",
    "plant",
    "host",
    "sim-harness",
    "tests",
    "verify",
    "scripts",
];

/// The sources in a folder and below it, without build products.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            if !path.ends_with("target") {
                sources(&path, found);
            }
        } else if path.extension().is_some_and(|it| it == "rs" || it == "py") {
            found.push(path);
        }
    }
}

#[test]
fn every_cause_of_a_hazard_has_tests_that_are_there() {
    let (_, hazards) = DOCUMENT.split_once("## Hazards").expect("the hazards");
    let rows = hazards
        .lines()
        .filter(|line| line.starts_with("| "))
        .skip(1);
    let causes: Vec<&str> = rows
        .map(|row| row.split(" | ").nth(1).expect("a cause"))
        .collect();
    let texts = all_sources();
    let lines: Vec<&str> = TESTS.lines().skip(1).collect();
    assert_eq!(lines.len(), causes.len());
    for (line, cause) in lines.into_iter().zip(causes) {
        let (what, names) = line.rsplit_once(',').expect("tests");
        assert!(what.contains(cause), "{line}: {cause}");
        assert!(!names.is_empty(), "{line}");
        for name in names.split(' ') {
            assert!(is_there(&texts, name), "there is no test {name}");
        }
    }
}

/// The texts of all sources in these folders.
pub(crate) fn all_sources() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    for folder in FOLDERS {
        sources(&root.join(folder), &mut files);
    }
    let read = |file: &PathBuf| fs::read_to_string(file).expect("a source");
    files.iter().map(read).collect()
}

/// Whether a source has a test of this name.
pub(crate) fn is_there(texts: &[String], name: &str) -> bool {
    let (rust, python) = (format!("fn {name}("), format!("def {name}("));
    let found = |text: &String| text.contains(&rust) || text.contains(&python);
    texts.iter().any(found)
}
