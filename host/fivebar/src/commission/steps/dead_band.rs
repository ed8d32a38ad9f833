//! The step that finds how little a servo answers: after a turn it rests on one side of its dead band, and moves again when its
//! pulse has gone through all of it.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::question::{Answer, Question};
use super::super::record::Value;
use super::Outcome;
use super::standing::{inwards, stand, turn};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::HobbyServo;

/// The turn after which a servo rests on one side [rad].
const TURN: f64 = 0.1;
/// The change of the pulse from one try to the next [s].
const CHANGE: f64 = 2e-6;
/// A dead band so many times that of the file is of a servo that is worn, or of a joint that is held.
const WORN: f64 = 4.0;

/// The dead band of both servos.
pub(in super::super) fn dead_band(bench: &mut Bench) -> Result<Outcome, StepError> {
    let Some(servos) = bench.robot.hobby_servos() else {
        return Err(StepError::other("the arm has no hobby servos"));
    };
    let from = stand(bench)?;
    let (mut values, mut found) = (Vec::new(), Vec::new());
    for joint in Joint::ALL {
        let servo = &servos[joint];
        let half = 0.5 * through(bench, from, joint, servo)?;
        if half > WORN * servo.dead_band {
            return Err(StepError::wrong(
                format_args!(
                    "the servo of {joint} does not answer a change of its pulse by {:.0} µs, and its dead_band is {:.0} µs",
                    1e6 * half,
                    1e6 * servo.dead_band
                ),
                "check that the joint turns freely and that the horn sits firmly on its servo; a worn servo is exchanged, or its \
                 dead_band stated",
            ));
        }
        let name = format!("dead_band{}_s", joint.number());
        let origin = "half the change of the pulse after which it turned back";
        values.push(Value::new(name, half, origin));
        found.push(format!("{joint}: {:.0} µs", 1e6 * half));
        turn(bench, from, joint, 0.0)?;
    }
    bench.power_off()?;
    Ok(Outcome::new(
        format!("each answers a change of its pulse, {}", found.join(", ")),
        values,
    ))
}

/// The change of the pulse [s] after which a joint that has turned inwards moves again outwards.
fn through(
    bench: &mut Bench,
    from: [f64; 2],
    joint: Joint,
    servo: &HobbyServo,
) -> Result<f64, StepError> {
    let by = inwards(bench, from, joint, TURN)?;
    turn(bench, from, joint, by)?;
    let most = 2.0 * WORN * servo.dead_band + 2.0 * CHANGE;
    let mut change = 0.0;
    while change < most {
        change += CHANGE;
        let back = change * servo.angle_per_width() / servo.gear_ratio.abs();
        turn(bench, from, joint, by - back.copysign(by))?;
        if bench.see(Question::Moves(joint))? == Answer::Moved {
            break;
        }
    }
    Ok(change)
}
