//! The steps of drives on a CAN bus: what their maker's program has to set, which drive is which, whether they turn their joints,
//! and whether they know where these are.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::operator::Task;
use super::super::record::Value;
use super::Outcome;
use super::inputs::{TURN_TOLERANCE, turned_by_hand};
use super::moving::middle;
use super::standing::{inwards, power_on, stand, turn};
use fivebar_files::robot::HomeMethod;
use fivebar_firmware::drives::can::{Protocol, watchdog};
use fivebar_firmware::safety::Fault;
use fivebar_kinematics::five_bar::Joint;

/// The turn that tries a motor [rad], and by how much it may be missed, as a share.
const LITTLE: f64 = 5.0 / 180.0 * std::f64::consts::PI;
const MISSED: f64 = 0.2;
/// The time for which both drives hold the arm [s]: on a bus that loses one frame in fifty, two in a row are missing by then.
const HOLDING: f64 = 5.0;
/// The share of a turn by hand above which a drive has answered.
const ANSWERED: f64 = 0.05;
/// What an ODrive is told about a torque constant that the robot file does not have.
const NO_CONSTANT: &str = "that of your motor, 8.27 (N·m/A) over its rpm/V, current_soft_max = its peak torque over that; write \
                           torque_constant into [[actuator]], and this step works the current out";
/// How far a joint may be from its home angle in its jig [rad].
const JIG: f64 = 5e-3;

/// The numbers of both drives on the bus.
fn nodes(bench: &Bench) -> Result<[u8; 2], StepError> {
    let drives = bench.robot.can_drives();
    let drives = drives.ok_or_else(|| StepError::other("this arm has no drives on a bus"))?;
    Ok(drives.map(|drive| drive.node))
}

/// What both drives are to be set to by their maker's program.
pub(in super::super) fn settings(bench: &mut Bench) -> Result<Outcome, StepError> {
    let nodes = nodes(bench)?;
    let timeout = 1e3 * f64::from(watchdog(bench.settings.control.tick_rate));
    let mut values = Vec::new();
    for joint in Joint::ALL {
        let drive = bench.drive(joint)?;
        let node = nodes[joint];
        // Without a torque constant nothing says which current gives the torque.
        let stated = drive.stated_torque_constant();
        let current = stated.map(|constant| (constant, drive.peak_current));
        let protocol = drive.can().map(|can| can.protocol);
        bench.report(match protocol {
            Some(Protocol::Odrive) => format!(
                "{joint}, ODrive: can.config.baud_rate = 1000000; axis0.config.can.node_id = {node}, heartbeat_msg_rate_ms = 10, \
                 the other messages 0; axis0.config.enable_watchdog = True, watchdog_timeout = {:.3} (s); \
                 axis0.config.motor.torque_constant = {}",
                1e-3 * timeout,
                current.map_or_else(
                    || NO_CONSTANT.into(),
                    |(constant, current)| {
                        format!("{constant} (N·m/A), current_soft_max = {current:.1} (A)")
                    }
                )
            ),
            _ => format!(
                "{joint}, MIT-type: 1 Mbit/s, its identifier {node}, the controller's 0; a time-out of {timeout:.0} ms if it has \
                 one; the ranges of position, velocity, stiffness, damping and torque as in [[actuator]]{}",
                current.map_or_else(String::new, |(_, current)| {
                    format!("; the motor's current {current:.1} A at most")
                })
            ),
        })?;
        let origin = "peak_torque of the robot file over torque_constant";
        values.extend(current.map(|(_, current)| {
            Value::new(format!("peak_current{}_a", joint.number()), current, origin)
        }));
    }
    bench.ask(Task::SetDrives)?;
    Ok(Outcome::new(
        format!(
            "joint 1 is node {}, joint 4 node {}, both with a watchdog of {timeout:.0} ms",
            nodes[0], nodes[1]
        ),
        values,
    ))
}

/// Each drive answers for its own joint, in its direction, and as far as the joint turns.
pub(in super::super) fn answers(bench: &mut Bench) -> Result<Outcome, StepError> {
    if bench.drive(Joint::Joint1)?.brake_torque > 0.0 {
        bench.report(
            "the brakes hold the joints: give them their voltage, or lift them, and hold the arm if it hangs",
        )?;
    }
    let mut turned = [[0.0; 2]; 2];
    for joint in Joint::ALL {
        let (by, told) = turned_by_hand(bench, joint)?;
        turned[joint] = told.map(|told| told / by);
    }
    bench.ask(Task::LetGo)?;
    let nodes = nodes(bench)?;
    // Whether the drive of this joint answers where that one was turned.
    let answers = |of: Joint, turning: Joint| turned[turning][of].abs() > ANSWERED;
    let crossed = Joint::ALL.map(|joint| !answers(joint, joint) && answers(joint.other(), joint));
    if crossed == [true; 2] {
        return Err(StepError::wrong(
            "the drives are swapped: joint 1 was turned and the drive of joint 4 tells it",
            "exchange their numbers (node), or the plugs of their motors and encoders",
        ));
    }
    let mut values = Vec::new();
    for joint in Joint::ALL {
        let share = turned[joint][joint];
        let (wrong, change) = match (answers(joint, joint), crossed) {
            (false, [true, _] | [_, true]) => {
                let answering = if crossed[0] {
                    Joint::Joint4
                } else {
                    Joint::Joint1
                };
                (
                    format!(
                        "both drives have number {}: none answers as {}",
                        nodes[answering],
                        nodes[answering.other()]
                    ),
                    "give each drive the number (node) of its [[actuator]]",
                )
            }
            (false, _) => (
                format!(
                    "the drive of {joint} does not answer as number {}",
                    nodes[joint]
                ),
                "check its supply, the wires of the bus (CANH, CANL, ground) at its plug, its number (node), which the other drive \
                 may have, its bit rate of 1 Mbit/s and its mode",
            ),
            (true, ..) if share < 0.0 => (
                format!("the drive of {joint} is reversed: it counts backwards"),
                "give a negative gear_ratio, or reverse the direction in the drive",
            ),
            (true, ..) if (share - 1.0).abs() > TURN_TOLERANCE => (
                format!(
                    "the gear ratio of {joint} is wrong: its drive tells {share:.2} times the angle that the joint was turned by"
                ),
                "correct gear_ratio, or the ranges of an MIT-type drive's frames",
            ),
            (true, ..) => {
                let name = format!("turn{}_share", joint.number());
                let origin = "angle that the drive told over 45° by hand";
                values.push(Value::new(name, share, origin));
                continue;
            }
        };
        return Err(StepError::wrong(wrong, change));
    }
    Ok(Outcome::new(
        "each drive tells the angle of its own joint, in its direction",
        values,
    ))
}

/// Both drives hold the arm, and each turns its own joint.
pub(in super::super) fn motors(bench: &mut Bench) -> Result<Outcome, StepError> {
    let mut values = Vec::new();
    let from = stand_anywhere(bench).map_err(|error| named(bench, error))?;
    bench.pause(HOLDING)?;
    if let Some(fault) = bench.client.status()?.0.fault {
        return Err(named(bench, StepError::Fault(fault)));
    }
    for joint in Joint::ALL {
        let before = bench.client.status()?.0.angle;
        let by = inwards(bench, from, joint, LITTLE)?;
        turn(bench, from, joint, by).map_err(|error| named(bench, error))?;
        let after = bench.client.status()?.0.angle;
        let share = f64::from(after[joint] - before[joint]) / by;
        if (share - 1.0).abs() > MISSED {
            return Err(no_torque(joint));
        }
        turn(bench, from, joint, 0.0).map_err(|error| named(bench, error))?;
        let name = format!("turn_under_power{}_share", joint.number());
        let origin = "angle that the drive told, over the one that it was to turn by";
        values.push(Value::new(name, share, origin));
    }
    bench.power_off()?;
    Ok(Outcome::new(
        "both drives hold the arm, and each turns its own joint",
        values,
    ))
}

fn no_torque(joint: Joint) -> StepError {
    StepError::wrong(
        format_args!("the motor of {joint} gives no torque: its joint does not follow"),
        "check the motor's three leads at the drive, the drive's calibration and its limit of the current, and whether the brake \
         is released",
    )
}

/// The arm where a hand has put it, with power; θ1, θ4 [rad]. Drives that know their angles need no more.
fn stand_anywhere(bench: &mut Bench) -> Result<[f64; 2], StepError> {
    if bench.robot.homing.method != HomeMethod::Absolute {
        return stand(bench);
    }
    let middle = middle(bench)?;
    bench.ask(Task::Place(middle))?;
    bench.ask(Task::LetGo)?;
    bench.home()?;
    power_on(bench)?;
    Ok(bench.client.status()?.0.angle.map(f64::from))
}

/// What a fault of drives on a bus means in these steps.
fn named(bench: &mut Bench, error: StepError) -> StepError {
    let mut latched = || bench.client.status().ok()?.0.fault;
    let fault = match error {
        StepError::Fault(fault) => fault,
        // What was asked for was refused because of a fault, maybe.
        error => match latched() {
            Some(fault) => fault,
            None => return error,
        },
    };
    match fault {
        Fault::FollowingError => bench
            .farthest_at_fault()
            .map_or_else(|| StepError::Fault(fault), no_torque),
        // After some answers that are missing the next one is a jump.
        Fault::DriveSilent | Fault::EncoderJump => StepError::wrong(
            "a drive does not answer in time while it has power, though both answered by hand: frames get lost, or a drive is in \
             another mode",
            "measure 60 Ω between CANH and CANL with the supply off: 120 Ω at each end and nowhere else; check the ground of the \
             bus, twisted wires, stubs below 0.3 m, and an MIT-type drive's mode",
        ),
        Fault::DriveError => StepError::wrong(
            "a drive tells an error, or gives no torque when it is told to",
            "read the error in its maker's program: a drive that is not calibrated gives no torque. If there is none, orders get \
             lost: measure 60 Ω between CANH and CANL with the supply off, and check the ground of the bus",
        ),
        Fault::BusOff => StepError::wrong(
            "the controller has left the bus after too many errors",
            "check CANH and CANL for a short or exchange, the bit rate of 1 Mbit/s, and the transceiver",
        ),
        fault => StepError::Fault(fault),
    }
}

/// Drives that know their angles know them rightly.
pub(in super::super) fn zero(bench: &mut Bench) -> Result<Outcome, StepError> {
    if bench.robot.homing.method != HomeMethod::Absolute {
        return Ok(Outcome::new(
            "the drives count from where they are switched on: homing finds the angles",
            vec![],
        ));
    }
    bench.ask(Task::Home)?;
    bench.home()?;
    let told = bench.pause(0.1)?.angle;
    bench.ask(Task::LetGo)?;
    let mut values = Vec::new();
    for joint in Joint::ALL {
        let off = f64::from(told[joint]) - bench.robot.home[joint];
        if off.abs() > JIG {
            return Err(StepError::wrong(
                format_args!(
                    "the drive of {joint} has lost its zero: in the jig it tells an angle that is {off:+.3} rad off"
                ),
                "set the zero of its encoder anew with its maker's program, with the arm in the jig",
            ));
        }
        let name = format!("zero_error{}_rad", joint.number());
        values.push(Value::new(
            name,
            off,
            "angle that the drive tells in the jig, less home",
        ));
    }
    Ok(Outcome::new(
        format!(
            "both drives tell the home angles in the jig within {:.0} mrad",
            1e3 * JIG
        ),
        values,
    ))
}
