//! The step that finds how much torque a stepper has in reserve: the share of the file's torque at which it loses steps.
//!
//! A driver tells nothing of its motor, but a lost step stays: the switch is then found at other micro-steps than before. So
//! the arm is homed, draws strokes that load one motor, is homed again, and the share grows until steps are lost. Then the
//! other motor is tried.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::operator::Task;
use super::super::record::Value;
use super::moving::{follow, middle, origins};
use super::{Outcome, measured, strokes};
use fivebar_files::robot::{self, HomeMethod, MeasuredKey, Robot};
use fivebar_firmware::Move;
use fivebar_kinematics::five_bar::Joint;
use fivebar_sim::drive::{Drive, DriveError, Homing};
use fivebar_sim::time_optimal::JobPlanner;
use std::f64::consts::TAU;

/// The first share, how it grows, and the greatest one.
const FIRST: f64 = 0.5;
const RISE: f64 = 0.1;
const MOST: f64 = 1.4;
/// Strokes that take more than this share of the time of those before use no more torque: other limits bound them.
const SHORTER: f64 = 0.99;
/// What goes into the file of the greatest share without lost steps, and the most: more than the file's torque is not
/// relied on.
const KEPT: f64 = 0.8;
const MOST_KEPT: f64 = 1.0;
/// A motor that loses steps at the first share has less torque than its file says, whatever the arm's masses are. One that
/// does so at less than this may have less, on an arm whose masses are those of the file: with 10 % less torque and masses
/// that are 15 % greater it keeps 0.5 to 0.6, on half the supply 0.6.
const USUAL: f64 = 0.65;

/// The torque in reserve.
pub(in super::super) fn reserve(bench: &mut Bench) -> Result<Outcome, StepError> {
    if bench.robot.homing.method != HomeMethod::Switch {
        return Ok(Outcome::left_out(
            "left out: without home switches nothing shows lost steps",
        ));
    }
    if bench.robot.has_steppers_with_encoders() {
        return Ok(Outcome::left_out(
            "left out: the encoders show in any motion whether a motor loses steps (fault 34)",
        ));
    }
    let file = bench.robot.clone();
    if let Err(error) = JobPlanner::new(&file, 1.0) {
        return Ok(Outcome::left_out(format!("left out: {error}")));
    }
    // The controller refuses no motion of any share meanwhile: the strokes are planned with theirs.
    bench.robot = with_shares(&file, [MOST; 2]);
    let kept = climb(bench, &file);
    bench.robot = file;
    let restored = bench.upload();
    let kept = kept?;
    restored?;
    let is_weak = Joint::ALL.map(|joint| kept[joint] < FIRST);
    if is_weak != [false; 2] {
        return Err(weak(is_weak, FIRST));
    }
    let mut outcome = Outcome::new("", vec![]);
    let mut found = Vec::new();
    for joint in Joint::ALL {
        let share = kept[joint];
        let kept = (KEPT * share).min(MOST_KEPT);
        found.push(format!(
            "{joint} loses no step up to {share:.1} of its torque: {kept:.2} goes into the file"
        ));
        let origin = "greatest share of the torque without lost steps";
        let name = format!("share{}_without_loss", joint.number());
        outcome.values.push(Value::new(name, share, origin));
        outcome.measured.push(measured(
            MeasuredKey::Actuator(joint, "torque_share"),
            format!("{kept:.2}"),
            format!("{KEPT} of {share:.1}, at which no step was lost"),
        ));
    }
    if kept[0].min(kept[1]) < USUAL {
        found.push(
            "that is less than usual: the supply may sag under load, the current may be too low (step current), or the arm may have \
             more mass than its file says"
                .into(),
        );
    }
    outcome.found = found.join("; ");
    Ok(outcome)
}

/// Motors that lose steps at this share of the file's torque, although any arm and motor may take so much.
fn weak(joints: [bool; 2], share: f64) -> StepError {
    if joints == [true; 2] {
        return StepError::wrong(
            format_args!(
                "both motors lose steps at {share:.1} of the torque that the robot file says they have: their supply or their \
                 current is too low"
            ),
            "check the motors' supply while the arm moves: it must not sag below [supply] voltage. If it does not, check the \
             current of both drivers (step current), and the masses in the robot file",
        );
    }
    let joint = if joints[0] {
        Joint::Joint1
    } else {
        Joint::Joint4
    };
    StepError::wrong(
        format_args!(
            "the motor of {joint} loses steps at {share:.1} of the torque that the robot file says it has: its current is too low"
        ),
        "check the current of its driver (step current: VREF, and whether the motor's data sheet means RMS), and whether the \
         joint turns freely. If it is meant, state the torque that the motor has at its current as holding_torque",
    )
}

/// The robot with these shares of its motors' torque.
fn with_shares(robot: &Robot, shares: [f64; 2]) -> Robot {
    let mut robot = robot.clone();
    for (actuator, share) in robot.actuators.iter_mut().flatten().zip(shares) {
        if let robot::Drive::Stepper(stepper) = &mut actuator.drive {
            stepper.torque_share = share;
        }
    }
    robot
}

/// The greatest share of each motor's torque with which it lost no step.
fn climb(bench: &mut Bench, file: &Robot) -> Result<[f64; 2], StepError> {
    let mut kept = [FIRST - RISE; 2];
    bench.upload()?;
    bench.home()?;
    let mut home = origins(bench)?;
    for joint in Joint::ALL {
        let mut shortest = f64::INFINITY;
        for rung in 0..=((MOST - FIRST) / RISE).round() as u32 {
            let share = FIRST + RISE * f64::from(rung);
            // The other motor has little to do, and its share bounds nothing.
            let mut shares = [MOST; 2];
            shares[joint] = share;
            let planned = strokes::plan(bench, &with_shares(file, shares), joint, MOST)?;
            let time = strokes::duration(&planned);
            if time > SHORTER * shortest {
                bench.report(format_args!(
                    "{joint} with {share:.1} of its torque: not tried, because the limits of speed and acceleration in the robot \
                     file let the arm use no more than before"
                ))?;
                break;
            }
            shortest = time;
            let lost = try_strokes(bench, &planned, joint, &mut home)?;
            bench.report(format_args!(
                "{joint} with {share:.1} of its torque: {}",
                match lost {
                    None => "no step was lost".into(),
                    Some(loser) => format!("{loser} has lost steps"),
                }
            ))?;
            match lost {
                None => kept[joint] = share,
                Some(loser) if loser == joint => break,
                Some(_) => return Err(weak(Joint::ALL.map(|one| one != joint), share)),
            }
        }
    }
    Ok(kept)
}

/// Draws strokes that load this joint; which motor has lost steps. `home` is where the switches were found, before and then
/// after them [rad].
fn try_strokes(
    bench: &mut Bench,
    planned: &[Move],
    joint: Joint,
    home: &mut [f64; 2],
) -> Result<Option<Joint>, StepError> {
    match follow(bench, planned) {
        Ok(()) => {}
        // Of an arm that is elsewhere than its controller takes it for.
        Err(StepError::Drive(DriveError::Fault(_))) => bench.clear()?,
        Err(error) => return Err(error),
    }
    let before = *home;
    let is_far = match Drive::new(&mut bench.client, &|| false).home(Homing::Always) {
        Ok(()) => false,
        Err(DriveError::Fault(_)) => true,
        Err(error) => return Err(error.into()),
    };
    if is_far {
        bench.clear()?;
        bench.report("the arm does not find its switches: it is far from where it should be")?;
        bench.ask(Task::Place(middle(bench)?))?;
        bench.ask(Task::LetGo)?;
        bench.home()?;
    }
    *home = origins(bench)?;
    if is_far {
        return Ok(Some(joint));
    }
    let motors = bench.robot.steppers();
    let has_lost = |joint: Joint| {
        // A rotor slips by four full steps at least.
        let step = motors.map_or(0.0, |motors| {
            TAU / f64::from(motors[joint].steps_per_turn) / motors[joint].gear_ratio.abs()
        });
        (home[joint] - before[joint]).abs() > 2.0 * step
    };
    Ok([joint, joint.other()]
        .into_iter()
        .find(|&one| has_lost(one)))
}
