//! `fivebar completions`: completion scripts for shells.

use super::Failure;
use super::command;
use super::say::print;
use clap_complete::{Shell, generate};

/// Prints a script with which a shell completes commands and options.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The shell.
    shell: Shell,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let mut script = Vec::new();
    generate(args.shell, &mut command(), "fivebar", &mut script);
    print(String::from_utf8_lossy(&script))
}
