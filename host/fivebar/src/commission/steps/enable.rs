//! The step that tries the enable wires of steppers, and their encoders if they have any.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::question::{Answer, Question};
use super::standing::stand;
use super::{Outcome, inputs};
use fivebar_kinematics::five_bar::Joint;

/// The encoders of steppers that have some.
pub(in super::super) fn encoders(bench: &mut Bench) -> Result<Outcome, StepError> {
    match bench.robot.has_steppers_with_encoders() {
        true => inputs::encoders(bench),
        false => Ok(Outcome::new(
            "the motors have no encoders: what they are told counts",
            vec![],
        )),
    }
}

/// Each joint turns by hand without power, and is held with it.
pub(in super::super) fn enable(bench: &mut Bench) -> Result<Outcome, StepError> {
    for joint in Joint::ALL {
        if bench.see(Question::IsHeld(joint))? == Answer::Held {
            return Err(StepError::wrong(
                format_args!("the driver of {joint} has power where it should have none"),
                "check its EN: the driver must be off while EN is high, and the pull-up must be at its module. If the joint \
                 is held without the motors' supply, too, its bearing or belt is stuck",
            ));
        }
    }
    stand(bench)?;
    for joint in Joint::ALL {
        if bench.see(Question::IsHeld(joint))? == Answer::Free {
            return Err(StepError::wrong(
                format_args!("the motor of {joint} gets no power"),
                "check the wire to EN, the motor's plug, and the motors' supply at the driver's VM",
            ));
        }
    }
    bench.power_off()?;
    Ok(Outcome::new(
        "both joints are free without power, and held with it",
        vec![],
    ))
}
