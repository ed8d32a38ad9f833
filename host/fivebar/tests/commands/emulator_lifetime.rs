//! The emulator ends with the program that started it, even if that is killed.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Waits up to 10 s until `poll` returns a value.
fn wait_for<T>(poll: impl Fn() -> Option<T>) -> Option<T> {
    (0..1000).find_map(|_| {
        let found = poll();
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
        .expect("`kill` starts")
        .success()
}

/// Writes a program with the emulator's name that records its process number and sleeps.
fn sleeping_emulator(folder: &Path) {
    let script = format!(
        "#!/bin/sh\necho $$ > '{0}/started'\nmv '{0}/started' '{0}/process'\nexec sleep 1000\n",
        folder.display()
    );
    let program = folder.join("qemu-system-arm");
    fs::write(&program, script).expect("the file can be written");
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755))
        .expect("the permissions can be set");
}

#[test]
fn the_emulator_ends_when_fivebar_is_killed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    sleeping_emulator(folder.path());
    let image = folder.path().join("image");
    fs::write(&image, "").expect("the file can be written");
    let path = std::env::var("PATH").unwrap_or_default();
    let mut fivebar = fivebar_testkit::program(env!("CARGO_BIN_EXE_fivebar"))
        .arg("pil")
        .arg("--image")
        .arg(&image)
        .current_dir(folder.path())
        .env("PATH", format!("{}:{path}", folder.path().display()))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let process = wait_for(|| fs::read_to_string(folder.path().join("process")).ok());
    let process = process.expect("the emulator starts");
    let process = process.trim();
    assert!(is_alive(process));

    fivebar.kill().expect("fivebar runs");
    fivebar.wait().expect("the exit status is readable");
    let ended = wait_for(|| (!is_alive(process)).then_some(()));
    assert!(ended.is_some(), "the emulator is still running");
}
