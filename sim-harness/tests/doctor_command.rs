//! `fivebar doctor` on machines that have everything, or nothing.
#![cfg(unix)]

use serde_json::Value;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

/// Asks the doctor where only the programs of one folder are to be found.
fn doctor(programs: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fivebar"));
    let command = command.arg("doctor").args(arguments);
    command.env("PATH", programs).output().unwrap()
}

fn install(folder: &Path, name: &str, prints: &str) {
    let path = folder.join(name);
    std::fs::write(&path, format!("#!/bin/sh\necho '{prints}'\n")).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
}

fn state<'a>(answer: &'a Value, what: &str) -> &'a Value {
    let checks = answer["checks"].as_array().unwrap();
    checks.iter().find(|check| check["what"] == what).unwrap()
}

#[test]
fn a_bare_machine_is_well_unless_more_is_wanted() {
    let empty = tempfile::tempdir().unwrap();
    let well = doctor(empty.path(), &[]);
    assert_eq!(well.status.code(), Some(0));
    let text = String::from_utf8(well.stdout).unwrap();
    assert!(text.contains("missing  qemu-system-arm"), "{text}");
    assert!(text.contains("cargo install probe-rs-tools"), "{text}");

    let unwell = doctor(empty.path(), &["pil", "browser"]);
    assert_eq!(unwell.status.code(), Some(1));
    let said = String::from_utf8(unwell.stderr).unwrap();
    assert!(
        said.contains("missing or outdated for pil and browser: "),
        "{said}"
    );
    for missing in ["qemu-system-arm", "chromium", "chromedriver", "python3"] {
        assert!(said.contains(missing), "{said}");
    }
    assert!(!said.contains("probe-rs"), "{said}");
    assert_eq!(doctor(empty.path(), &["surgery"]).status.code(), Some(2));
}

#[test]
fn what_is_there_is_told_with_its_version() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["chromium", "chromedriver", "python3"] {
        install(folder.path(), name, "Version 7");
    }
    // A program that does not even tell its version does not work.
    std::fs::write(folder.path().join("maturin"), "").unwrap();
    let output = doctor(folder.path(), &["browser", "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(answer["ready"], true);
    assert_eq!(answer["asked"][0], "browser");
    assert_eq!(state(&answer, "chromium")["found"], "Version 7");
    assert_eq!(state(&answer, "chromium")["needed_for"][0], "browser");
    let maturin = state(&answer, "maturin");
    assert!(maturin["missing"].as_str().unwrap().contains("pip install"));
    assert_eq!(maturin["needed_for"].as_array().unwrap().len(), 0);
}
