//! `fivebar man`: manual pages, made from the definition of the command line.

use super::command;
use super::failure::{Failure, refused};
use super::say::{print, say};
use clap_mangen::Man;
use fivebar_report::output::write_in;
use std::path::PathBuf;

/// Prints the manual, or writes one page for each command.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The folder for fivebar.1, fivebar-sim.1 and so on; by default all pages are printed.
    dir: Option<PathBuf>,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    for page in pages() {
        let mut text = Vec::new();
        page.render(&mut text).map_err(refused)?;
        match &args.dir {
            Some(folder) => {
                write_in(folder, &page.get_filename(), text).map_err(refused)?;
            }
            None => print(String::from_utf8_lossy(&text))?,
        }
    }
    if let Some(folder) = &args.dir {
        say(format_args!(
            "wrote {} pages to {}",
            pages().count(),
            folder.display()
        ))?;
    }
    Ok(())
}

/// The page of the program, then the page of each command.
fn pages() -> impl Iterator<Item = Man> {
    let mut program = command().disable_help_subcommand(true);
    program.build();
    let version = format!("Fivebar {}", env!("CARGO_PKG_VERSION"));
    let commands: Vec<_> = program.get_subcommands().cloned().collect();
    let all = std::iter::once(program).chain(commands);
    all.map(move |command| Man::new(command).source(version.clone()))
}
