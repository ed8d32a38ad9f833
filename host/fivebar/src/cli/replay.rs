//! `fivebar replay`: a taught motion, done again.

use super::failure::{Failure, refused};
use super::port::interrupted;
use super::say::{leave_output_to, say, warn_of_drivers};
use super::serve::ControllerArgs;
use super::teach::{opened, write};
use fivebar_files::robot::Robot;
use fivebar_files::text_file::{LARGEST_TOML, read_text};
use fivebar_sim::drive::{Drive, DriveError, Homing, planner_at};
use fivebar_sim::teaching::{ReplayError, TaughtPath};
use std::path::PathBuf;
use std::sync::atomic::Ordering;

/// Does a motion again that `fivebar teach` has recorded.
///
/// It is checked as a whole before the arm moves. The robot is that of the record, unless --robot names another one.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The file of `fivebar teach`.
    path: PathBuf,
    #[command(flatten)]
    controller: ControllerArgs,
    /// In times of the taught speed, 0.05 to 5.
    #[arg(long, value_name = "S", default_value_t = 1.0)]
    speed: f64,
    /// Write the path as .gcode, .svg or .json in place of moving an arm.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Why it is not done again.
#[derive(Debug, thiserror::Error)]
enum Undone {
    #[error(transparent)]
    Drive(#[from] DriveError),
    #[error(transparent)]
    Replay(#[from] ReplayError),
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let named =
        |error: &dyn std::fmt::Display| refused(format_args!("{}: {error}", args.path.display()));
    let text = read_text(&args.path, LARGEST_TOML).map_err(|error| named(&error))?;
    let path = TaughtPath::parse(&text).map_err(|error| named(&error))?;
    if let Some(out) = &args.out {
        leave_output_to(out);
        return write(out, &path);
    }
    let robot = Robot::load(&args.controller.robot).map_err(refused)?;
    warn_of_drivers(&robot);
    if robot.name != path.robot {
        return Err(named(&format_args!(
            "it was taught to `{}`, and the robot is `{}`: name that one with --robot",
            path.robot, robot.name
        )));
    }
    let interrupted = interrupted()?;
    let wants_stop = || interrupted.load(Ordering::Relaxed);
    let mut session = opened(&args.controller, &robot, None)?;
    let settings = session.settings;
    let mut drive = Drive::new(&mut session, &wants_stop);
    let done = (|| -> Result<(), Undone> {
        drive.home(Homing::IfUnknown)?;
        drive.switch_on()?;
        let status = drive.fault_free_status()?;
        let planner = planner_at(&settings, &status)?;
        let tip = status.tool.ok_or(DriveError::NoTool)?;
        let moves = path.replay(args.speed, &planner, tip, status.angle)?;
        Ok(drive.follow_armed(&moves, &[], &mut |_, _| (), &mut |_| Ok(true))?)
    })();
    let stopped = session.stop_arm();
    done.map_err(|error| named(&error))?;
    stopped.map_err(refused)?;
    say(format_args!(
        "{}: {:.1} mm in {:.2} s done, bridges off",
        args.path.display(),
        1e3 * path.length(),
        path.time() / args.speed
    ))
}
