//! A session with a controller: what every program does that moves an arm through it.

use super::command_error::sentence;
use super::simulated::SteppedArm;
use super::source::Connection;
use crate::clock::Clock;
use crate::drive::Controlled;
use crate::link::{Client, LinkError};
use crate::safe_exit;
use fivebar_firmware::protocol::HostCommand;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::CheckedSettings;
use fivebar_firmware::{Request, Status};
use std::time::Duration;

/// Longest time for the arm to come to rest when the program ends.
const LONGEST_STOP: Duration = Duration::from_secs(5);

/// A controller with the settings of the robot, and its latest status.
pub struct Session {
    /// The connection to the controller.
    pub client: Client<Box<dyn Connection>>,
    /// The simulated arm of a board in lockstep.
    stepped: Option<Box<dyn SteppedArm>>,
    /// The robot's settings, which the controller has.
    pub settings: CheckedSettings,
    /// The latest status that was read or that the controller has sent.
    pub status: Status,
    /// The time by which the session and those who use it wait.
    pub clock: Clock,
}

impl Session {
    /// A session with a controller that has these settings. It reads the status.
    pub(super) fn new(
        mut client: Client<Box<dyn Connection>>,
        stepped: Option<Box<dyn SteppedArm>>,
        settings: CheckedSettings,
        clock: Clock,
    ) -> Result<Self, LinkError> {
        let (status, _) = client.status()?;
        Ok(Self {
            client,
            stepped,
            settings,
            status,
            clock,
        })
    }

    /// A session with a controller that has a clock of its own, and these settings. It reads the status.
    ///
    /// # Errors
    /// The connection failed.
    pub fn over(
        client: Client<Box<dyn Connection>>,
        settings: CheckedSettings,
        clock: Clock,
    ) -> Result<Self, LinkError> {
        Self::new(client, None, settings, clock)
    }

    /// Whether the controller is a board in lockstep, whose time is slower than real time.
    pub fn is_in_lockstep(&self) -> bool {
        self.stepped.is_some()
    }

    /// Makes a request of the controller; its refusal as a sentence.
    ///
    /// # Errors
    /// The connection failed.
    pub fn request(&mut self, request: Request) -> Result<Result<(), String>, LinkError> {
        let answer = self.client.command(HostCommand::Request(request))?;
        Ok(answer.map_err(|refusal| sentence(&refusal)))
    }

    /// Reads the status, which is also the sign of life. Returns the free entries of the controller's
    /// queue of moves.
    ///
    /// # Errors
    /// The connection failed.
    pub fn read_status(&mut self) -> Result<u8, LinkError> {
        let (status, free) = self.client.status()?;
        self.status = status;
        Ok(free)
    }

    /// Waits a moment for messages of the controller, or runs a few ticks of a board in lockstep.
    ///
    /// # Errors
    /// The connection failed.
    pub fn pass_time(&mut self) -> Result<(), LinkError> {
        match &mut self.stepped {
            Some(arm) => arm.step(&mut self.client),
            None => self.client.poll(),
        }
    }

    /// Brings the arm to rest and switches the bridges off.
    ///
    /// # Errors
    /// The connection failed.
    pub fn stop_arm(&mut self) -> Result<(), LinkError> {
        let deadline = self.clock.now() + LONGEST_STOP;
        // Refused if a fault is latched: then the controller itself brings the arm to rest.
        let _ = self.request(Request::Stop)?;
        loop {
            self.read_status()?;
            if !safe_exit::moves(&self.status) || self.clock.now() > deadline {
                break;
            }
            self.pass_time()?;
        }
        if self.request(Request::Disarm)?.is_ok() {
            self.wait_until_off()?;
        }
        // A fault may hold the arm with the bridges on, or a move queued before may have begun.
        self.read_status()?;
        if safe_exit::ends_by_emergency_stop(&self.status) {
            let _ = self.request(Request::EmergencyStop)?;
        }
        Ok(())
    }

    /// Stops the arm after its use ended with `outcome`, also after a reply that made no sense; a
    /// controller that is silent or not reached stops it by its own timeout.
    ///
    /// # Errors
    /// Those of `outcome`, or the connection failed.
    pub fn stop_after(&mut self, outcome: Result<(), LinkError>) -> Result<(), LinkError> {
        match outcome {
            Err(LinkError::Silent | LinkError::Connection(_)) => outcome,
            Ok(()) | Err(_) => outcome.and(self.stop_arm()),
        }
    }

    /// Waits until an accepted request has switched the bridges off: holding brakes engage before. If
    /// they do not hold, the arm stays held under a fault.
    ///
    /// # Errors
    /// The connection failed.
    pub fn wait_until_off(&mut self) -> Result<(), LinkError> {
        let deadline = self.clock.now() + LONGEST_STOP;
        loop {
            self.read_status()?;
            let failed = self.status.fault == Some(Fault::BrakeFailed);
            if self.status.state == State::Stopped || failed || self.clock.now() > deadline {
                return Ok(());
            }
            self.pass_time()?;
        }
    }
}

/// Rounds of a board in lockstep in some 10 ms of its time.
const ROUNDS: u32 = 5;

impl Controlled for Session {
    type Line = Box<dyn Connection>;

    fn client(&mut self) -> &mut Client<Self::Line> {
        &mut self.client
    }

    fn pass_time(&mut self) -> Result<(), LinkError> {
        let rounds = if self.is_in_lockstep() { ROUNDS } else { 1 };
        (0..rounds).try_for_each(|_| Self::pass_time(self))
    }
}

#[cfg(test)]
mod tests {
    use super::{LONGEST_STOP, Session};
    use crate::clock::Clock;
    use crate::controller::{Connection, simulated};
    use crate::link::{Client, Tracer};
    use fivebar_files::robot::Robot;
    use fivebar_firmware::protocol::{HostCommand, Reply};
    use fivebar_firmware::safety::State;
    use fivebar_firmware::{Move, MoveKind, Request};
    use std::io::{self, Write};
    use std::sync::{Arc, Mutex};
    use std::time::Duration;

    /// What a tracer writes.
    #[derive(Clone, Default)]
    struct Trace(Arc<Mutex<Vec<u8>>>);

    impl Write for Trace {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    /// Passes time until the status is as wanted.
    fn wait(session: &mut Session, wanted: impl Fn(&Session) -> bool) {
        let start = session.clock.now();
        loop {
            session.read_status().unwrap();
            if wanted(session) {
                return;
            }
            let passed = session.clock.since(start);
            assert!(passed < Duration::from_secs(60), "it takes long");
            session.pass_time().unwrap();
        }
    }

    /// A session with the simulated benchtop arm, which moves.
    fn moving(trace: Trace) -> Session {
        let robot = Robot::load("benchtop").unwrap();
        let clock = Clock::simulated();
        let line = Tracer::new(simulated::line(&robot, &clock, None).unwrap(), trace);
        let line: Box<dyn Connection> = Box::new(line);
        let (client, _) = Client::open(line).unwrap();
        let settings = robot.settings().unwrap().check().unwrap();
        let mut session = Session::over(client, settings, clock).unwrap();
        let refusal = session.request(Request::Arm).unwrap().unwrap_err();
        assert_eq!(refusal, "The joint angles are unknown: home first.");
        session.request(Request::Home).unwrap().unwrap();
        wait(&mut session, |session| session.status.homed);
        session.wait_until_off().unwrap();
        session.request(Request::Arm).unwrap().unwrap();
        wait(&mut session, |session| session.status.reference.is_some());
        let [x, y] = session.status.reference.unwrap();
        let kind = MoveKind::Line {
            to: [x + 0.03, y],
            feed: 0.1,
        };
        let (tag, tool) = (1, 0);
        let next = HostCommand::Move(Move { tag, tool, kind });
        let reply = session.client.call(next).unwrap();
        assert!(matches!(reply, Reply::Taken { .. }), "{reply:?}");
        wait(&mut session, |session| {
            session.status.velocity.iter().any(|rate| rate.abs() > 0.2)
        });
        session
    }

    #[test]
    fn a_session_brings_a_moving_arm_to_rest_before_it_switches_the_bridges_off() {
        let trace = Trace::default();
        let mut session = moving(trace.clone());
        let begun = session.clock.now();
        session.stop_arm().unwrap();
        assert_eq!(session.status.state, State::Stopped);
        assert!(session.clock.since(begun) < LONGEST_STOP, "it rested");
        let trace = String::from_utf8(trace.0.lock().unwrap().clone()).unwrap();
        let (before, _) = trace.rsplit_once("Request(Disarm)").unwrap();
        let status = before.lines().rfind(|line| line.contains("reply: Status"));
        let status = status.expect("a status before the end");
        assert!(status.contains("state: Armed"), "{status}");
    }
}
