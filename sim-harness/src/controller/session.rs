//! A session with a controller: what every program does that moves an arm through it.

use super::command_error::sentence;
use super::simulated::SteppedArm;
use super::source::Connection;
use crate::held;
use crate::link::{Client, LinkError};
use fivebar_firmware::protocol::HostCommand;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::CheckedSettings;
use fivebar_firmware::{Request, Status};
use std::time::{Duration, Instant};

/// Longest time for the arm to come to rest when the program ends.
const LONGEST_STOP: Duration = Duration::from_secs(5);

/// A controller with the settings of the robot, and its latest status.
pub struct Session {
    /// The connection to the controller.
    pub client: Client<Box<dyn Connection>>,
    /// The simulated arm of a board in lockstep.
    stepped: Option<SteppedArm>,
    /// The robot's settings, which the controller has.
    pub settings: CheckedSettings,
    /// The latest status that was read or that the controller has sent.
    pub status: Status,
}

impl Session {
    /// A session with a controller that has these settings. It reads the status.
    pub(super) fn new(
        mut client: Client<Box<dyn Connection>>,
        stepped: Option<SteppedArm>,
        settings: CheckedSettings,
    ) -> Result<Self, LinkError> {
        let (status, _) = client.status()?;
        Ok(Self {
            client,
            stepped,
            settings,
            status,
        })
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
        let deadline = Instant::now() + LONGEST_STOP;
        // Refused if a fault is latched: then the controller itself brings the arm to rest.
        let _ = self.request(Request::Stop)?;
        loop {
            self.read_status()?;
            if !held::moves(&self.status) || Instant::now() > deadline {
                break;
            }
            self.pass_time()?;
        }
        if self.request(Request::Disarm)?.is_ok() {
            self.wait_until_off()?;
        }
        // A fault may hold the arm with the bridges on.
        self.read_status()?;
        if held::ends_by_emergency_stop(&self.status) {
            let _ = self.request(Request::EmergencyStop)?;
        }
        Ok(())
    }

    /// Waits until an accepted request has switched the bridges off: holding brakes engage before. If
    /// they do not hold, the arm stays held under a fault.
    ///
    /// # Errors
    /// The connection failed.
    pub fn wait_until_off(&mut self) -> Result<(), LinkError> {
        let deadline = Instant::now() + LONGEST_STOP;
        loop {
            self.read_status()?;
            let failed = self.status.fault == Some(Fault::BrakeFailed);
            if self.status.state == State::Stopped || failed || Instant::now() > deadline {
                return Ok(());
            }
            self.pass_time()?;
        }
    }
}
