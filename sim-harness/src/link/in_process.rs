//! The controller in this process.

use super::{Target, TargetError};
use fivebar_firmware::controller::{Controller, Request};
use fivebar_firmware::planner::{MoveErrorKind, Planner};
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::{SettingsError, Share};
use fivebar_firmware::{ActuatorCommand, Move, SensorSample, Settings, Status};

/// The firmware's controller and planner, called directly.
pub struct InProcess {
    controller: Controller,
    planner: Planner,
}

impl InProcess {
    /// A controller with these settings, as after a reset.
    ///
    /// # Errors
    /// The first setting that is not valid.
    pub fn new(settings: &Settings) -> Result<Self, SettingsError> {
        let settings = settings.check()?;
        Ok(Self {
            controller: Controller::new(&settings),
            planner: Planner::new(&settings),
        })
    }
}

impl InProcess {
    /// The level, as a share, that an output of the tool stands for.
    pub(super) fn tool_level(&self, output: Share) -> f32 {
        self.controller.settings().tool_output.level(output)
    }
}

impl Target for InProcess {
    fn tick(&mut self, sample: &SensorSample) -> Result<(ActuatorCommand, Status), TargetError> {
        // This call is the host's sign of life.
        self.controller.feed_host_timeout();
        self.planner.run(&mut self.controller);
        let command = self.controller.tick(sample);
        Ok((command, self.controller.status()))
    }

    fn request(&mut self, request: Request) -> Result<(), TargetError> {
        let refused = |error| TargetError::Request { request, error };
        self.controller.request(request).map_err(refused)
    }

    fn offer(&mut self, next: &Move) -> Result<bool, TargetError> {
        match self.planner.push(&mut self.controller, next) {
            Ok(()) => Ok(true),
            Err(error) if error.kind == MoveErrorKind::Full => Ok(false),
            Err(error) => Err(TargetError::Move(error)),
        }
    }

    fn is_idle(&self) -> bool {
        self.planner.is_empty() && self.controller.state() == State::Armed
    }
}
