//! The process that reads jobs for the pages has limits, which hold before it reads anything.

use fivebar_testkit::{Running, program};
use std::io::Write as _;
use std::os::unix::process::ExitStatusExt as _;
use std::process::{ChildStdin, Stdio};

/// The process, and its input.
fn started() -> (Running, ChildStdin) {
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
    let mut child = Running::start(
        command
            .arg("read-job-apart")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null()),
    );
    let input = child.stdin.take().unwrap();
    (child, input)
}

#[test]
fn a_process_that_reads_a_job_has_a_gigabyte_of_memory_and_seconds_of_the_processor() {
    let (child, mut input) = started();
    // More than a pipe holds: when all of it is written, the process has begun to read.
    let length = 1_u32 << 20;
    input.write_all(&length.to_le_bytes()).unwrap();
    input.write_all(&[0; 200_000]).unwrap();
    let limits = std::fs::read_to_string(format!("/proc/{}/limits", child.id())).unwrap();
    let limit = |name: &str| {
        let line = limits.lines().find_map(|line| line.strip_prefix(name));
        line.unwrap().split_whitespace().next().unwrap().to_owned()
    };
    assert_eq!(limit("Max address space"), (1_u64 << 30).to_string());
    let seconds: u32 = limit("Max cpu time").parse().unwrap();
    // A build without optimisation is ten times slower.
    assert!((5..=50).contains(&seconds), "{seconds} s");
    assert_eq!(limit("Max core file size"), "0");
}

#[test]
fn a_job_that_asks_for_four_gigabytes_ends_its_process_alone() {
    let (mut child, mut input) = started();
    input.write_all(&u32::MAX.to_le_bytes()).unwrap();
    drop(input);
    let status = child.wait().unwrap();
    assert_eq!(status.signal(), Some(6), "{status}");
}
