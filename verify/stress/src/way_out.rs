//! Every state has a way out: from wherever a controller is, the same commands of a host lead to
//! motion again, or a refusal names why the arm cannot move.

use crate::rules::Violation;
use fivebar_firmware::controller::{Request, RequestError};
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::protocol::{CommandError, HostCommand, VERSION};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{Move, MoveKind, Status};

const RULE: &str = "every state has a way out to motion, or to a named reason";

/// Longest time for an arm to come to rest, and to follow the move at the end [ticks].
const TIMEOUT_TICKS: u32 = 20_000;
/// Ticks of a mean of the current sensors' zeros with the bridges off.
const ZEROS: u32 = 4_400;
/// The move at the end turns joint 1 by so much [rad].
const TURN: f32 = 2e-3;
/// The number of the session.
const SESSION: u32 = 0xe417;

/// A controller with a host, an arm and a tick. Nothing disturbs the arm any more.
pub(crate) trait Machine {
    /// Sends a command. Returns why it was refused, if it was.
    fn send(&mut self, command: HostCommand) -> Result<Option<CommandError>, Violation>;

    /// Time passes, and the host asks for the status.
    fn pass(&mut self, ticks: u32) -> Result<(), Violation>;

    fn status(&self) -> Status;

    /// The true θ1, θ4 [rad].
    fn angles(&self) -> [f32; 2];
}

/// Where the way out leads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum WayOut {
    /// The arm follows a path.
    Motion,
    /// The arm cannot move where it is.
    Reason(CommandError),
    /// The arm does not do what its settings say.
    Fault(Fault),
}

/// Gives the commands, one after the other.
///
/// # Errors
/// The state or the refusal that is no way out.
pub(crate) fn way_out(machine: &mut impl Machine) -> Result<WayOut, Violation> {
    let hello = HostCommand::Hello {
        version: VERSION,
        session: SESSION,
    };
    done(machine, hello)?;
    // An excitation, a homing, a path and a stop end; a fault refuses this.
    let _ = machine.send(HostCommand::Request(Request::Stop))?;
    wait(machine, "it does not come to rest", rests)?;
    if machine.status().state == State::Fault {
        clear_fault(machine)?;
    } else {
        done(machine, HostCommand::Request(Request::Disarm))?;
    }
    wait(machine, "the power does not go off", |status| {
        is_off(status) || status.fault == Some(Fault::BrakeFailed)
    })?;
    if machine.status().fault == Some(Fault::BrakeFailed) {
        done(machine, HostCommand::Request(Request::EmergencyStop))?;
        clear_fault(machine)?;
        wait(machine, "the power does not go off", is_off)?;
    }
    if let Some(error) = declare_and_arm(machine)? {
        match error {
            // New settings start a new controller.
            CommandError::NoSettings
            | CommandError::Request(RequestError::NotOnBranch | RequestError::NotHomed) => {
                done(machine, HostCommand::ApplySettings)?;
            }
            CommandError::Request(RequestError::CurrentZero) => {}
            reason => return named(machine, reason),
        }
        machine.pass(ZEROS)?;
        if let Some(reason) = declare_and_arm(machine)? {
            return named(machine, reason);
        }
    }
    let [theta1, theta4] = machine.angles();
    let kind = MoveKind::Joint {
        to: [theta1 + TURN, theta4],
        speed: 0.1,
    };
    let (tag, tool) = (u32::MAX, 0);
    if let Some(reason) = machine.send(HostCommand::Move(Move { tag, tool, kind }))? {
        return match machine.status().fault {
            Some(fault) if is_of_the_arm(fault) => Ok(WayOut::Fault(fault)),
            _ => named(machine, reason),
        };
    }
    wait(machine, "no motion begins", |status| {
        matches!(status.state, State::Running | State::Fault)
    })?;
    wait(machine, "the motion does not end", |status| {
        matches!(status.state, State::Armed | State::Fault)
    })?;
    match machine.status().fault {
        None => Ok(WayOut::Motion),
        Some(fault) if is_of_the_arm(fault) => Ok(WayOut::Fault(fault)),
        Some(_) => Err(trapped(machine, "the motion ends with a fault")),
    }
}

/// The bridges are off, and no fault is latched.
fn is_off(status: &Status) -> bool {
    status.state == State::Stopped && status.joint_reference.is_none()
}

/// Whether an arm that differs from its settings can raise this fault.
fn is_of_the_arm(fault: Fault) -> bool {
    matches!(
        fault,
        Fault::EncoderJump
            | Fault::FollowingError
            | Fault::OverSpeed
            | Fault::OverCurrent
            | Fault::OverTemperature
            | Fault::UnderVoltage
            | Fault::OverVoltage
            | Fault::Envelope
            | Fault::Oscillation
            | Fault::LostCounts
    )
}

fn declare_and_arm(machine: &mut impl Machine) -> Result<Option<CommandError>, Violation> {
    let angles = machine.angles();
    if let Some(error) = machine.send(HostCommand::Request(Request::SetAngles(angles)))? {
        return Ok(Some(error));
    }
    machine.send(HostCommand::Request(Request::Arm))
}

/// Clears the fault as soon as the arm rests.
fn clear_fault(machine: &mut impl Machine) -> Result<(), Violation> {
    let clear = HostCommand::Request(Request::ClearFault);
    for _ in 0..TIMEOUT_TICKS {
        match machine.send(clear)? {
            Some(CommandError::Request(RequestError::Moving)) => machine.pass(1)?,
            Some(error) => return Err(trapped(machine, &format!("{clear:?}: {error:?}"))),
            None => return Ok(()),
        }
    }
    Err(trapped(machine, "the fault cannot be cleared"))
}

/// A command that must be executed.
fn done(machine: &mut impl Machine, command: HostCommand) -> Result<(), Violation> {
    match machine.send(command)? {
        None => Ok(()),
        Some(error) => Err(trapped(
            machine,
            &format!("{command:?} is refused: {error:?}"),
        )),
    }
}

/// A refusal that says what about the arm or its surroundings must change.
fn named(machine: &impl Machine, error: CommandError) -> Result<WayOut, Violation> {
    let is_named = match error {
        CommandError::Request(error) => matches!(
            error,
            RequestError::OutsideLimits
                | RequestError::NearSingularity
                | RequestError::NotOnBranch
                | RequestError::CurrentZero
        ),
        CommandError::Move(error) => !matches!(
            error.kind,
            MoveErrorKind::State(_) | MoveErrorKind::Full | MoveErrorKind::Discontinuous
        ),
        _ => false,
    };
    if is_named {
        Ok(WayOut::Reason(error))
    } else {
        Err(trapped(machine, &format!("{error:?}")))
    }
}

/// An arm that nothing moves, and whose state does not end by itself.
fn rests(status: &Status) -> bool {
    let reference = status.joint_reference;
    let still = reference.is_none_or(|joints| joints.velocity == [0.0; 2]);
    match status.state {
        State::Stopped | State::Armed | State::Fault => still,
        State::Homing
        | State::Exciting
        | State::Running
        | State::Stopping
        | State::Crossing
        | State::Compliant => false,
    }
}

fn wait(
    machine: &mut impl Machine,
    otherwise: &str,
    is_reached: fn(&Status) -> bool,
) -> Result<(), Violation> {
    for _ in 0..TIMEOUT_TICKS {
        if is_reached(&machine.status()) {
            return Ok(());
        }
        machine.pass(1)?;
    }
    Err(trapped(machine, otherwise))
}

fn trapped(machine: &impl Machine, found: &str) -> Violation {
    let status = machine.status();
    let (state, fault) = (status.state, status.fault);
    Violation::new(
        status.tick,
        RULE,
        format_args!("in {state:?}, {fault:?}: {found}"),
    )
}
