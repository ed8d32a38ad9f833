//! `fivebar completions`: what a shell completes.

use super::command;
use super::failure::{Failure, refused};
use clap_complete::{Shell, generate};
use std::io::{self, Write};

/// Prints what a shell needs to complete commands and options.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The shell.
    shell: Shell,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let mut script = Vec::new();
    generate(args.shell, &mut command(), "fivebar", &mut script);
    io::stdout().write_all(&script).map_err(refused)
}
