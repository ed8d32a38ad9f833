//! The tests that `docs/design/safety.md` names must exist.

use std::fs;
use std::path::{Path, PathBuf};

const DOCUMENT: &str = include_str!("../../../docs/design/safety.md");
/// Where tests are, from the repository's root.
const FOLDERS: [&str; 8] = [
    "kinematics",
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
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    for folder in FOLDERS {
        sources(&root.join(folder), &mut files);
    }
    let texts: Vec<String> = files
        .iter()
        .map(|file| fs::read_to_string(file).expect("a source"))
        .collect();
    for name in names {
        let (rust, python) = (format!("fn {name}("), format!("def {name}("));
        let found = |text: &String| text.contains(&rust) || text.contains(&python);
        assert!(texts.iter().any(found), "there is no test {name}");
    }
}
