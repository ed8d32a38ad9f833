//! A session with a simulated arm whose time passes only while the host waits, so that what a test finds does
//! not depend on how busy the machine is.

use fivebar_files::robot::Robot;
use fivebar_firmware::Request;
use fivebar_sim::clock::Clock;
use fivebar_sim::controller::{ControllerSource, Session, open};

/// Rounds of 10 ms within which whatever a test waits for must have come.
pub(crate) const ROUNDS: u32 = 3000;

pub(crate) fn robot() -> Robot {
    Robot::load("benchtop").unwrap()
}

/// A session with the benchtop arm, not homed, its bridges off.
pub(crate) fn session() -> Session {
    let clock = Clock::simulated();
    open(&robot(), ControllerSource::Simulated, &clock)
        .unwrap()
        .0
}

/// The same after homing.
pub(crate) fn homed() -> Session {
    let mut session = session();
    session.request(Request::Home).unwrap().unwrap();
    for _ in 0..ROUNDS {
        session.read_status().unwrap();
        if session.status.homed {
            session.wait_until_off().unwrap();
            return session;
        }
        session.pass_time().unwrap();
    }
    panic!("homing takes long: {:?}", session.status);
}
