//! `fivebar robots`: the built-in robots.

use super::Failure;
use super::say::{print, say};
use fivebar_files::did_you_mean;
use fivebar_files::robot::{BUILT_IN, BuiltIn};

/// Lists the built-in robots, or prints the file of one.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The robot whose file is printed.
    name: Option<String>,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let Some(name) = &args.name else {
        for robot in BUILT_IN {
            say(format_args!("{:<15} {}", robot.name, robot.summary()))?;
        }
        return Ok(());
    };
    let robot = BuiltIn::find(name).ok_or_else(|| {
        Failure::Usage(format!(
            "there is no built-in robot `{name}`; `fivebar robots` lists them{}",
            did_you_mean(name, BUILT_IN.iter().map(|robot| robot.name))
        ))
    })?;
    print(robot.text)?;
    Ok(())
}
