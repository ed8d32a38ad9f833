//! The controller's errors as sentences that say what to do.

use fivebar_firmware::controller;
use fivebar_firmware::protocol::CommandError;
use fivebar_firmware::safety::State;

/// Why a command was refused.
pub fn sentence(error: &CommandError) -> String {
    match error {
        CommandError::Move(error) if error.tag == 0 => format!("The move is refused: {error}."),
        CommandError::Move(error) => format!("Line {} is refused: {error}.", error.tag),
        CommandError::Request(error) => match error {
            controller::RequestError::State(state) => format!("Not allowed {}.", while_in(*state)),
            controller::RequestError::NotHomed => {
                "The joint angles are unknown: home first.".into()
            }
            controller::RequestError::OutsideLimits => {
                "A joint is outside its limits: disarm, then turn the joint back by hand.".into()
            }
            controller::RequestError::NearSingularity => {
                "The arm is too near a singularity: disarm, then move the arm away by hand.".into()
            }
            controller::RequestError::NotOnBranch => {
                "No pose on the arm's branch has these joint angles: home again.".into()
            }
            controller::RequestError::Moving => {
                "The arm is still moving: wait until it rests.".into()
            }
            other => format!("The request is refused: {other}."),
        },
        CommandError::Stream(error) => format!("No stream begins: {error}."),
        CommandError::NoSettings => {
            "The controller has no settings: store the robot's settings with --upload.".into()
        }
        other => format!("The controller refuses: {other:?}."),
    }
}

fn while_in(state: State) -> &'static str {
    match state {
        State::Stopped => "while the arm is stopped: home it, then arm it",
        State::Homing => "while the arm is homing: wait, or stop it",
        State::Exciting => "while a motor is being measured: wait, or stop it",
        State::Armed => "while the arm is armed: disarm it first",
        State::Running => "while the arm is moving: stop it first",
        State::Crossing => "while the arm crosses a singularity: wait until it rests",
        State::Compliant => "while a hand leads the arm: end that first",
        State::Stopping => "while the arm is stopping: wait until it rests",
        State::Fault => "while a fault is latched: clear it, then arm",
    }
}
