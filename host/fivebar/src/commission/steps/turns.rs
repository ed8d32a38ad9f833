//! The steps that turn one joint at a time by a stated angle and ask what was to be seen: directions, and how far.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::question::{Answer, Question};
use super::super::record::Value;
use super::Outcome;
use super::standing::{inwards, stand, turn};
use fivebar_kinematics::five_bar::Joint;

/// A turn that nobody overlooks, and that hurts nothing if it is of another joint or eight times as far [rad].
const LITTLE: f64 = 5.0 / 180.0 * std::f64::consts::PI;
/// A turn that shows by its size what the micro-steps are [rad].
const FAR: f64 = 4.0 * LITTLE;

/// What is wrong where a joint does not turn as it should, in the words of a kind of drive: what it is, and what to change.
struct Mistakes {
    reversed: &'static str,
    swapped: [&'static str; 2],
    hums: [&'static str; 2],
    nothing: [&'static str; 2],
}

const STEPPERS: Mistakes = Mistakes {
    reversed: "exchange the two leads of one phase; if motor and joint turn against each other, give a negative gear_ratio",
    swapped: [
        "the motors are swapped: the driver of",
        "exchange the motors' plugs at the drivers",
    ],
    hums: [
        "hums and does not turn: a phase is missing, or the phases are crossed",
        "measure the motor's leads, with the supply off: the two of a phase have a few ohms between them and none to the \
         other phase; each phase belongs to one pair of the driver's outputs. If they are right, check that the joint turns \
         freely and that the driver has its current",
    ],
    nothing: [
        "gets no steps: nothing moves",
        "check the wires to STEP and DIR, and the ground between controller and driver",
    ],
};

const SERVOS: Mistakes = Mistakes {
    reversed: "give a negative gear_ratio, or turn the servo over",
    swapped: [
        "the servos are swapped: the output of",
        "exchange the servos' plugs at the board",
    ],
    hums: [
        "hums and does not turn",
        "check that the joint turns freely: a servo that is held gets hot and is spoilt within minutes",
    ],
    nothing: [
        "gets no pulses, or its supply is too low: nothing moves",
        "check the signal's wire, the ground between board and servo, and the voltage at the servo's plug while it should turn: \
         below 3.5 V it does nothing",
    ],
};

/// Each stepper turns its own joint, forwards.
pub(in super::super) fn directions(bench: &mut Bench) -> Result<Outcome, StepError> {
    tried(bench, &STEPPERS)
}

/// Each servo turns its own joint, forwards.
pub(in super::super) fn servo_directions(bench: &mut Bench) -> Result<Outcome, StepError> {
    tried(bench, &SERVOS)
}

fn tried(bench: &mut Bench, mistakes: &Mistakes) -> Result<Outcome, StepError> {
    let from = stand(bench)?;
    for joint in Joint::ALL {
        let by = inwards(bench, from, joint, LITTLE)?;
        turn(bench, from, joint, by)?;
        let (wrong, change) = match bench.see(Question::Way(joint, by))? {
            Answer::AsAsked => {
                turn(bench, from, joint, 0.0)?;
                continue;
            }
            Answer::OtherWay => (
                format!("the motor of {joint} is reversed: it turns its joint backwards"),
                mistakes.reversed,
            ),
            Answer::OtherJoint => {
                let [wrong, change] = mistakes.swapped;
                (format!("{wrong} {joint} turns {}", joint.other()), change)
            }
            Answer::Hums => {
                let [wrong, change] = mistakes.hums;
                (format!("the motor of {joint} {wrong}"), change)
            }
            _ => {
                let [wrong, change] = mistakes.nothing;
                (format!("the motor of {joint} {wrong}"), change)
            }
        };
        return Err(StepError::wrong(wrong, change));
    }
    bench.power_off()?;
    Ok(Outcome::new(
        "each motor turns its own joint, forwards",
        vec![],
    ))
}

/// Each joint turns as far as it is told.
pub(in super::super) fn distances(bench: &mut Bench) -> Result<Outcome, StepError> {
    let from = stand(bench)?;
    let mut values = Vec::new();
    for joint in Joint::ALL {
        let by = inwards(bench, from, joint, FAR)?;
        turn(bench, from, joint, by)?;
        match bench.see(Question::Far(joint, by))? {
            Answer::Share(1.0) => turn(bench, from, joint, 0.0)?,
            other => return Err(wrong_scale(bench, joint, other)),
        }
        let name = format!("turn{}_share", joint.number());
        let origin = "angle as seen, over the one that was told";
        values.push(Value::new(name, 1.0, origin));
    }
    bench.power_off()?;
    Ok(Outcome::new(
        "each joint turns as far as it is told",
        values,
    ))
}

/// What is wrong with a joint that turns by another angle than it is told.
fn wrong_scale(bench: &Bench, joint: Joint, seen: Answer) -> StepError {
    let Some(motors) = bench.robot.steppers() else {
        let turns = match seen {
            Answer::Share(share) => format!("{share} times as far as"),
            _ => "by another angle than".into(),
        };
        return StepError::wrong(
            format_args!("the travel of {joint} is wrong: it turns {turns} it is told"),
            "measure the crank's angle at both widths of pulse_range, and correct travel",
        );
    };
    let Answer::Share(share) = seen else {
        return StepError::wrong(
            format_args!("{joint} turns by another angle than it is told, and by no power of two"),
            "check gear_ratio, steps_per_turn (200 of 1.8°, 400 of 0.9°) and microsteps of the robot file, whether the belt \
             slips, and the current of its driver",
        );
    };
    let told = f64::from(motors[joint].microsteps);
    StepError::wrong(
        format_args!(
            "the micro-steps of {joint} are wrong: it turns {share} times as far as it is told, so its driver makes {} of a full \
             step, and the robot file has {told}",
            told / share
        ),
        "set the driver's micro-steps (MS1 and MS2, or its UART) as the robot file has them, or correct microsteps there",
    )
}
