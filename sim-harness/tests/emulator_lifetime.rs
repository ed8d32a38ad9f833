//! An emulator ends with the program that started it, even if that is killed.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Waits up to 10 s for something.
fn wait_for<T>(what: impl Fn() -> Option<T>) -> Option<T> {
    (0..1000).find_map(|_| {
        let found = what();
        if found.is_none() {
            std::thread::sleep(Duration::from_millis(10));
        }
        found
    })
}

fn is_alive(process: &str) -> bool {
    Command::new("kill")
        .args(["-0", process])
        .stderr(Stdio::null())
        .status()
        .expect("kill")
        .success()
}

/// A folder with a program called like the emulator, which writes down its process and
/// sleeps instead.
fn sleeping_emulator(folder: &Path) {
    let script = format!(
        "#!/bin/sh\necho $$ > '{0}/started'\nmv '{0}/started' '{0}/process'\nexec sleep 1000\n",
        folder.display()
    );
    let program = folder.join("qemu-system-arm");
    fs::write(&program, script).expect("room");
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).expect("a mode");
}

#[test]
fn a_killed_fivebar_leaves_no_emulator_behind() {
    let folder = tempfile::tempdir().expect("a folder");
    sleeping_emulator(folder.path());
    let image = folder.path().join("image");
    fs::write(&image, "").expect("room");
    let path = std::env::var("PATH").unwrap_or_default();
    let mut fivebar = Command::new(env!("CARGO_BIN_EXE_fivebar"))
        .arg("pil")
        .arg("--image")
        .arg(&image)
        .current_dir(folder.path())
        .env("PATH", format!("{}:{path}", folder.path().display()))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program");
    let process = wait_for(|| fs::read_to_string(folder.path().join("process")).ok());
    let process = process.expect("the emulator was started");
    let process = process.trim();
    assert!(is_alive(process));

    fivebar.kill().expect("it ran");
    fivebar.wait().expect("it is ours");
    let gone = wait_for(|| (!is_alive(process)).then_some(()));
    assert!(gone.is_some(), "the emulator outlives it");
}
