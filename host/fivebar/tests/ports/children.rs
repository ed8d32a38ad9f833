//! No program that a test starts outlives its test.

use fivebar_testkit::{Running, program};
use std::os::unix::process::ExitStatusExt as _;
use std::panic::catch_unwind;
use std::path::PathBuf;
use std::sync::Mutex;
use std::thread;

/// A program that ends by itself after a minute, unless it is killed.
fn minute() -> Running {
    Running::start(program("sleep").arg("60"))
}

#[test]
fn a_program_is_killed_when_the_thread_of_its_test_ends_however_that_ends() {
    let started = || {
        let child = minute();
        let name = format!("/proc/{}/comm", child.id());
        // From then on the system kills it with its thread.
        while std::fs::read_to_string(&name).expect("it runs").trim() != "sleep" {
            thread::yield_now();
        }
        child.into_child()
    };
    let ended = thread::spawn(started).join();
    let status = ended.expect("its thread").wait().expect("its status");
    assert_eq!(status.signal(), Some(9), "{status}");
}

#[test]
fn a_program_is_gone_when_its_test_has_failed() {
    let started = Mutex::new(PathBuf::new());
    let failed = catch_unwind(|| {
        let child = minute();
        *started.lock().unwrap() = PathBuf::from(format!("/proc/{}", child.id()));
        // As a failed assertion does, but without its message.
        std::panic::resume_unwind(Box::new(()));
    });
    let started = started.into_inner().unwrap();
    assert!(failed.is_err() && started.starts_with("/proc"));
    assert!(!started.exists(), "{} runs", started.display());
}
