//! `fivebar bridge` as a program.

use crate::sender::Sender;
use fivebar_testkit::{Running, program};
use std::io::{BufRead as _, BufReader};
use std::process::Stdio;

/// The program, which ends when this value is dropped.
pub(crate) struct Bridge {
    pub(crate) child: Running,
    pub(crate) address: String,
    pub(crate) terminal: String,
}

impl Bridge {
    pub(crate) fn start() -> Self {
        Self::start_with(&["--listen", "127.0.0.1:0"])
    }

    pub(crate) fn start_with(options: &[&str]) -> Self {
        let mut child = Running::start(
            program(env!("CARGO_BIN_EXE_fivebar"))
                .arg("bridge")
                .args(options)
                .stdout(Stdio::piped())
                .stderr(Stdio::piped()),
        );
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("its output"))
            .read_line(&mut line)
            .expect("a line of text");
        let (address, terminal) = line.trim().split_once(' ').expect("two words");
        Self {
            child,
            address: address.into(),
            terminal: terminal.into(),
        }
    }

    pub(crate) fn connect(&self) -> Sender {
        Sender::connect(&self.address)
    }
}

pub(crate) fn near([x, y]: [f64; 2], [to_x, to_y]: [f64; 2], within: f64) -> bool {
    (x - to_x).hypot(y - to_y) < within
}
