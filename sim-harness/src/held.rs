//! What a program must know of a controller before it leaves it.

use fivebar_firmware::Status;
use fivebar_firmware::safety::{Fault, Response, State};

/// A joint slower than this rests [rad/s].
const REST: f32 = 0.05;

/// Whether the arm still moves with power. A fault that holds the arm brings it to rest first.
pub fn moves(status: &Status) -> bool {
    match status.state {
        State::Running | State::Stopping | State::Crossing | State::Homing | State::Exciting => {
            true
        }
        State::Fault => {
            is_held(status) && status.velocity.iter().any(|velocity| velocity.abs() > REST)
        }
        State::Stopped | State::Armed => false,
    }
}

/// Whether a fault holds the arm with the bridges on, and an emergency stop may end that. After
/// failed brakes it may not: the arm would fall. The controller switches it off a minute later.
pub fn ends_by_emergency_stop(status: &Status) -> bool {
    is_held(status) && status.fault != Some(Fault::BrakeFailed)
}

fn is_held(status: &Status) -> bool {
    let response = status.fault.map(Fault::response);
    response == Some(Response::ControlledStop)
}
