//! `fivebar pen`: the heights of a pen that a servo lifts.

use super::failure::{Failure, refused};
use super::port::interrupted;
use super::say::{say, warn};
use super::serve::{ControllerArgs, keep};
use super::teach::opened;
use crate::pen_heights::{Height, KeepValues, PenTrial};
use fivebar_files::robot::Robot;
use fivebar_sim::controller::Session;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// Time between two looks whether Ctrl-C was pressed.
const LOOK: Duration = Duration::from_millis(50);

/// Tries the heights of a pen that a servo lifts, and keeps them in the robot file.
///
/// Type `up 1.05` or `down 1.60`, the width of the pulse in ms, and Enter: the servo goes there; the motors are off. `keep` writes
/// both into the robot file and the controller's memory. The end of the input or Ctrl-C ends it. Home the arm afterwards.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    controller: ControllerArgs,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let robot = Robot::load(&args.controller.robot).map_err(refused)?;
    let keep = keep(args.controller.robot.clone());
    let interrupted = interrupted()?;
    let mut session = opened(&args.controller, &robot, None)?;
    let mut trial = PenTrial::of(&session.settings).map_err(refused)?;
    show(&trial)?;
    let done = listen(&mut session, &mut trial, &keep, &interrupted);
    let ended = PenTrial::end(&mut session).map_err(refused)?;
    done.and(ended.map_err(refused))
}

fn show(trial: &PenTrial) -> Result<(), Failure> {
    let [up, down] = trial.widths.map(|width| 1e3 * width);
    say(format_args!("up {up:.2} ms, down {down:.2} ms"))
}

/// Does what the lines of the standard input say, until it ends or Ctrl-C is pressed.
fn listen(
    session: &mut Session,
    trial: &mut PenTrial,
    keep: &KeepValues,
    interrupted: &AtomicBool,
) -> Result<(), Failure> {
    let (sender, lines) = mpsc::channel();
    thread::spawn(move || {
        io::stdin()
            .lines()
            .map_while(Result::ok)
            .try_for_each(|line| sender.send(line))
    });
    while !interrupted.load(Ordering::Relaxed) {
        let line = match lines.recv_timeout(LOOK) {
            Ok(line) => line,
            Err(RecvTimeoutError::Timeout) => continue,
            Err(RecvTimeoutError::Disconnected) => break,
        };
        match order(session, trial, keep, line.trim())? {
            Ok(()) => show(trial)?,
            Err(why) => warn(why),
        }
    }
    Ok(())
}

/// Does what a line says; why it cannot be done.
fn order(
    session: &mut Session,
    trial: &mut PenTrial,
    keep: &KeepValues,
    line: &str,
) -> Result<Result<(), String>, Failure> {
    let words: Vec<_> = line.split_whitespace().collect();
    let hold = match words[..] {
        [] => return Ok(Ok(())),
        ["keep"] => return trial.keep(session, keep).map_err(refused),
        ["up", width] => width.parse().ok().map(|width: f64| (Height::Up, width)),
        ["down", width] => width.parse().ok().map(|width: f64| (Height::Down, width)),
        _ => None,
    };
    match hold {
        Some((height, width)) => trial.hold(session, height, 1e-3 * width).map_err(refused),
        None => Ok(Err(format!(
            "`{line}` is no order: type `up 1.05` or `down 1.60` [ms], or `keep`"
        ))),
    }
}
