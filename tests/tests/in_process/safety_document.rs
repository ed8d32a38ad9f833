//! The tests that `docs/design/safety.md` names must exist.

use std::fs;
use std::path::{Path, PathBuf};

const DOCUMENT: &str = include_str!("../../../docs/design/safety.md");
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
fn every_test_it_names_is_there() {
    let (_, hazards) = DOCUMENT.split_once("## Hazards").expect("the hazards");
    let cells = hazards.lines().filter(|line| line.starts_with("| "));
    let last = cells.filter_map(|line| line.trim_matches('|').rsplit('|').next());
    let names: Vec<&str> = last
        .flat_map(|cell| cell.split('`').skip(1).step_by(2))
        .collect();
    assert!(names.len() >= 40, "{names:?}");
    let texts = all_sources();
    for name in names {
        assert!(is_there(&texts, name), "there is no test {name}");
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
