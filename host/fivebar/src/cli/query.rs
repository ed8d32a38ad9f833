//! `fivebar query`: answers queries about a robot, line by line.

use super::failure::{Failure, refused};
use super::say::warn;
use fivebar_files::robot::{BuiltIn, Mechanism};
use fivebar_report::study::query::{five_bar, serve, slider};
use std::io::{self, IsTerminal};

/// Answers queries about a robot: JSON lines in, JSON lines out.
///
/// Each line of the standard input is an object with an "op": "forward", "inverse",
/// "motion", "inverse_dynamics" or "forward_dynamics". Each query gets one line, in the same
/// order: the answer, or {"error": "unreachable" | "singular" | "invalid", "message": …}. For
/// a file with mechanism = "slider" the "op" is "forward", "inverse", "motion",
/// "inverse_motion", "error_transfer" or "reach". Torques are those of masses, payload, gravity and
/// rotors; the friction of the robot file is not in them.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A built-in robot or a robot file.
    #[arg(long, value_name = "FILE", default_value = BuiltIn::DEFAULT)]
    robot: String,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let mechanism = Mechanism::load(&args.robot).map_err(refused)?;
    if io::stdin().is_terminal() {
        warn(
            "one JSON object a line, Ctrl-D ends; such as {\"op\": \"forward\", \"theta1\": 2.4, \"theta4\": 0.8, \"assembly\": \"left\"}",
        );
    }
    let (input, output) = (io::stdin().lock(), io::stdout().lock());
    match mechanism {
        Mechanism::FiveBar(robot) => serve(input, output, &five_bar::KEYS, |query| {
            five_bar::answer(&robot, query)
        }),
        Mechanism::Slider(robot) => serve(input, output, &slider::KEYS, |query| {
            slider::answer(&robot, query)
        }),
    }
    .map_err(|error| {
        refused(format_args!(
            "cannot read queries or write answers: {error}"
        ))
    })
}
