//! The command `fivebar doctor` on machines with and without the programs that it checks.

use fivebar_testkit::program;
use serde_json::Value;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Output;

/// Runs `fivebar doctor` with only one folder in PATH.
fn doctor(programs: &Path, arguments: &[&str]) -> Output {
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
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
fn missing_programs_fail_only_the_checks_that_are_named() {
    let empty = tempfile::tempdir().unwrap();
    let unrestricted = doctor(empty.path(), &[]);
    assert_eq!(unrestricted.status.code(), Some(0));
    let text = String::from_utf8(unrestricted.stdout).unwrap();
    assert!(text.contains("missing  qemu-system-arm"), "{text}");
    assert!(text.contains("cargo install probe-rs-tools"), "{text}");

    let named = doctor(empty.path(), &["pil", "browser"]);
    assert_eq!(named.status.code(), Some(1));
    let message = String::from_utf8(named.stderr).unwrap();
    assert!(
        message.contains("missing or outdated for pil and browser: "),
        "{message}"
    );
    for missing in ["qemu-system-arm", "chromium", "chromedriver", "python3"] {
        assert!(message.contains(missing), "{message}");
    }
    assert!(!message.contains("probe-rs"), "{message}");
    assert_eq!(doctor(empty.path(), &["surgery"]).status.code(), Some(2));
}

#[test]
fn installed_programs_are_listed_with_their_version() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["chromium", "chromedriver", "python3"] {
        install(folder.path(), name, "Version 7");
    }
    // A program that does not print its version counts as missing.
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
