//! `fivebar query`: answers about an arm for scripts, line by line.

use super::failure::{Failure, refused};
use crate::input::robot::{BuiltIn, Mechanism};
use crate::study::query::{five_bar, serve, slider};
use std::io;

/// Answers questions about an arm: JSON lines in, JSON lines out.
///
/// Each line of the standard input is an object with an "op": "forward", "inverse",
/// "motion", "inverse_dynamics" or "forward_dynamics". Each is answered by one line in
/// the same order; what cannot be answered by {"error": "unreachable" | "singular" |
/// "invalid", "message": …}. A file with mechanism = "slider" is asked "forward",
/// "inverse", "motion", "inverse_motion", "error_transfer" or "reach".
#[derive(clap::Args)]
pub(super) struct Args {
    /// A built-in robot or a robot file.
    #[arg(long, value_name = "FILE", default_value = BuiltIn::DEFAULT)]
    robot: String,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let mechanism = Mechanism::load(&args.robot).map_err(refused)?;
    let (input, output) = (io::stdin().lock(), io::stdout().lock());
    match mechanism {
        Mechanism::FiveBar(robot) => {
            serve(input, output, |request| five_bar::answer(&robot, request))
        }
        Mechanism::Slider(robot) => serve(input, output, |request| slider::answer(&robot, request)),
    }
    .map_err(|error| refused(format_args!("the client broke off: {error}")))
}
