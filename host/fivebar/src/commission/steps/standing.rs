//! An arm that stands powered at a place that a hand has shown, and turns one joint by a stated angle: what can be tried
//! before anything of the motors is known.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::operator::Task;
use super::moving::middle;
use fivebar_files::robot::HomeMethod;
use fivebar_firmware::protocol::{HostCommand, Reply};
use fivebar_firmware::safety::State;
use fivebar_firmware::{Move, MoveKind, Request};
use fivebar_kinematics::five_bar::Joint;

/// The speed of a joint [rad/s].
const SPEED: f64 = 0.5;
/// The time in which a rotor that has got its current comes to rest, and in which a motion has begun [s].
const SETTLING: f64 = 0.3;
const BEGINNING: f64 = 0.1;

/// Asks for the arm where nothing is near it and switches the motors on there; θ1, θ4 [rad]. That is the middle of the
/// workspace, as exact as a hand has put it, so only turns from there mean anything; or home, where drives that know their
/// angle turn to at once.
pub(super) fn stand(bench: &mut Bench) -> Result<[f64; 2], StepError> {
    let at = match bench.robot.homing.method {
        HomeMethod::Absolute => {
            bench.home()?;
            bench.robot.home
        }
        _ => {
            let middle = middle(bench)?;
            bench.ask(Task::Place(middle))?;
            bench.ask(Task::LetGo)?;
            bench.request(Request::SetAngles(middle.map(|angle| angle as f32)))?;
            middle
        }
    };
    power_on(bench)?;
    Ok(at)
}

/// Switches the motors of a homed arm on, unless they are.
pub(super) fn power_on(bench: &mut Bench) -> Result<(), StepError> {
    if bench.client.status()?.0.state == State::Stopped {
        bench.request(Request::Arm)?;
    }
    bench.pause(SETTLING)?;
    Ok(())
}

/// A turn of this size from there [rad] that leads towards the middle of the workspace.
pub(super) fn inwards(
    bench: &Bench,
    from: [f64; 2],
    joint: Joint,
    size: f64,
) -> Result<f64, StepError> {
    Ok(size.copysign(middle(bench)?[joint] - from[joint]))
}

/// Turns a joint by an angle [rad] from where the arm stands [rad]; the simulated operator looks.
pub(super) fn turn(
    bench: &mut Bench,
    from: [f64; 2],
    joint: Joint,
    by: f64,
) -> Result<(), StepError> {
    let mut to = from.map(|angle| angle as f32);
    to[joint] += by as f32;
    let share = SPEED / bench.robot.limits.max_speed[joint];
    bench.operator.look();
    go(
        bench,
        MoveKind::Joint {
            to,
            speed: share.min(1.0) as f32,
        },
    )
}

/// Does a motion of the powered arm, which is held afterwards.
pub(super) fn go(bench: &mut Bench, kind: MoveKind) -> Result<(), StepError> {
    let next = Move {
        tag: 0,
        tool: 0,
        kind,
    };
    match bench.client.call(HostCommand::Move(next))? {
        Reply::Taken { .. } => {}
        Reply::Refused(error) => {
            return Err(StepError::wrong(
                format_args!("the arm cannot move around the middle of its workspace: {error}"),
                "check limits.angle and singularity_margin of the robot file",
            ));
        }
        other => return Err(StepError::other(format_args!("no motion: {other:?}"))),
    }
    let mut status = bench.pause(BEGINNING)?;
    loop {
        match (status.state, status.fault) {
            (_, Some(fault)) => return Err(StepError::Fault(fault)),
            (State::Armed, None) => break,
            _ => status = bench.pause(0.01)?,
        }
    }
    bench.pause(SETTLING)?;
    Ok(())
}
