//! The program `fivebar`.

use std::process::ExitCode;

fn main() -> ExitCode {
    fivebar::cli::main()
}
