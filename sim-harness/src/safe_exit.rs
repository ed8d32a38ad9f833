//! What a program must know of a controller before it leaves it.

use fivebar_firmware::Status;
use fivebar_firmware::safety::{Fault, Response, State};

/// A joint slower than this rests [rad/s].
const REST: f32 = 0.05;

/// Whether the arm still moves with power. A fault that holds the arm brings it to rest first.
pub fn moves(status: &Status) -> bool {
    match status.state {
        State::Running
        | State::Stopping
        | State::Crossing
        | State::Compliant
        | State::Homing
        | State::Exciting => true,
        State::Fault => {
            is_held(status) && status.velocity.iter().any(|velocity| velocity.abs() > REST)
        }
        State::Stopped | State::Armed => false,
    }
}

/// Whether only an emergency stop can switch the bridges off now: disarming was refused or has not
/// ended. After failed brakes none is wanted: the arm would fall. The controller switches it off a
/// minute later.
pub fn ends_by_emergency_stop(status: &Status) -> bool {
    match status.state {
        State::Stopped => false,
        State::Fault => is_held(status) && status.fault != Some(Fault::BrakeFailed),
        State::Armed
        | State::Running
        | State::Stopping
        | State::Crossing
        | State::Compliant
        | State::Homing
        | State::Exciting => true,
    }
}

fn is_held(status: &Status) -> bool {
    let response = status.fault.map(Fault::response);
    response == Some(Response::ControlledStop)
}

#[cfg(test)]
mod tests {
    use super::ends_by_emergency_stop;
    use fivebar_files::robot::Robot;
    use fivebar_firmware::safety::{Fault, Response, State};
    use fivebar_firmware::{Controller, Status};

    #[test]
    fn an_emergency_stop_ends_every_powered_state_but_failed_brakes() {
        let settings = Robot::load("benchtop").unwrap().settings().unwrap();
        let status = Controller::new(&settings.check().unwrap()).status();
        for state in State::ALL {
            for fault in Fault::all() {
                let powered = match state {
                    State::Fault => fault.response() == Response::ControlledStop,
                    state => state != State::Stopped,
                };
                let falls = state == State::Fault && fault == Fault::BrakeFailed;
                let status = Status {
                    state,
                    fault: Some(fault),
                    ..status
                };
                let ends = ends_by_emergency_stop(&status);
                assert_eq!(ends, powered && !falls, "{state:?}, {fault:?}");
            }
        }
    }
}
