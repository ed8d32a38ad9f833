//! `fivebar ros`: the arm as a node of ROS 2.

use super::failure::{Failure, refused};
use super::serve::ControllerArgs;
use super::value_error::ValueError;

/// Makes the arm a node of ROS 2: joint states, frames, URDF and diagnostics; trajectories by topic and action; services.
///
/// No ROS has to be installed, but the program must be built with `--features ros`. By default the arm is simulated in real
/// time.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    controller: ControllerArgs,
    /// The name of the node, before its services and its action.
    #[arg(long, value_name = "NAME", default_value = "fivebar")]
    name: String,
    /// The domain of the node: it sees nodes of the same one only.
    #[arg(long, value_name = "N", env = "ROS_DOMAIN_ID", default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=232))]
    domain: u16,
    /// Messages of the joints' states per second [Hz].
    #[arg(long, value_name = "HZ", default_value_t = 100.0, value_parser = rate)]
    rate: f64,
}

fn rate(text: &str) -> Result<f64, ValueError> {
    let rate = text.parse().ok();
    rate.filter(|rate| (1.0..=200.0).contains(rate))
        .ok_or(ValueError::RosRate)
}

#[cfg(not(feature = "ros"))]
pub(super) fn run(_: &Args) -> Result<(), Failure> {
    Err(refused(
        "this program was built without ROS 2; build it with `--features ros`",
    ))
}

#[cfg(feature = "ros")]
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    use super::port::interrupted;
    use super::say::{say, warn_of_drivers};
    use super::serve::described;
    use crate::ros::{RosOptions, serve};
    use fivebar_files::robot::Robot;
    use fivebar_sim::live::{LiveArm, Pace};
    use std::sync::Arc;
    use std::sync::atomic::Ordering;
    let robot = Robot::load(&args.controller.robot).map_err(refused)?;
    warn_of_drivers(&robot);
    let interrupted = interrupted()?;
    let image = args.controller.image(&robot);
    let source = args.controller.source(&image);
    let arm = LiveArm::open(&robot, source, Pace::RealTime)
        .map_err(|error| described(error, &args.controller, &robot))?;
    let arm = Arc::new(arm);
    let options = RosOptions {
        name: args.name.clone(),
        domain: args.domain,
        rate: args.rate,
    };
    say(format_args!(
        "{}: node /{} in domain {}, {}; Ctrl-C ends it",
        robot.name,
        options.name,
        options.domain,
        arm.place()
    ))?;
    let served = serve(&arm, &options, &|| interrupted.load(Ordering::Relaxed));
    let closed = arm.close();
    served.map_err(refused)?;
    closed.map_err(refused)
}
