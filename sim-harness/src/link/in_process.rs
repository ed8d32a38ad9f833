//! The controller in this process.

use super::{DesktopDrives, Target, TargetError};
use fivebar_firmware::controller::{ArmController, Request};
use fivebar_firmware::drives::{BrushedDrives, DriveInterface};
use fivebar_firmware::motion::{StreamConfig, StreamPoint};
use fivebar_firmware::planner::{
    MoveErrorKind, Planner, StreamError, StreamProgress, StreamReason,
};
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::{SettingsError, Share};
use fivebar_firmware::{ArmCommand, ArmSample, Move, Settings, Status};

/// The firmware's controller and planner, called directly.
pub struct InProcess<I: DesktopDrives = BrushedDrives>(Box<dyn Called<I>>);

/// A controller of an [`InProcess`].
pub trait Called<I: DriveInterface>: Target<I> + Send {
    /// The level, as a share, that an output of the tool stands for.
    fn tool_level(&self, output: Share) -> f32;

    /// Begins a stream of set-points.
    ///
    /// # Errors
    /// Why it does not begin.
    fn begin_stream(&mut self, config: &StreamConfig) -> Result<(), StreamError>;

    /// Takes the n-th point of the stream, or counts why not.
    fn take_point(&mut self, n: u16, point: &StreamPoint);

    /// Ends the stream behind its last point.
    fn end_stream(&mut self);

    /// What the stream has done.
    fn stream(&self) -> Option<StreamProgress>;
}

/// The controller with its planner and what lies between it and the wires.
struct Firmware<I: DriveInterface> {
    controller: ArmController<I::Drives>,
    planner: Planner,
    link: I::Link,
}

/// A controller with these settings, as after a reset.
pub(super) fn called<I>(settings: &Settings) -> Result<Box<dyn Called<I>>, SettingsError>
where
    I: DriveInterface<Drives: Send> + 'static,
{
    let settings = settings.check()?;
    Ok(Box::new(Firmware::<I> {
        controller: ArmController::new(&settings),
        planner: Planner::new(&settings),
        link: I::link(&settings),
    }))
}

impl<I: DesktopDrives> InProcess<I> {
    /// A controller with these settings, as after a reset.
    ///
    /// # Errors
    /// The first setting that is not valid.
    pub fn new(settings: &Settings) -> Result<Self, SettingsError> {
        I::called(settings).map(Self)
    }

    /// The level, as a share, that an output of the tool stands for.
    pub(super) fn tool_level(&self, output: Share) -> f32 {
        self.0.tool_level(output)
    }

    /// The controller itself.
    pub(super) fn called(&mut self) -> &mut dyn Called<I> {
        &mut *self.0
    }
}

impl<I: DesktopDrives> Target<I> for InProcess<I> {
    fn tick(
        &mut self,
        sample: &ArmSample<I::Sample>,
    ) -> Result<(ArmCommand<I::Command>, Status), TargetError> {
        self.0.tick(sample)
    }

    fn request(&mut self, request: Request) -> Result<(), TargetError> {
        self.0.request(request)
    }

    fn offer(&mut self, next: &Move) -> Result<bool, TargetError> {
        self.0.offer(next)
    }

    fn is_idle(&self) -> bool {
        self.0.is_idle()
    }
}

impl<I: DriveInterface<Drives: Send>> Called<I> for Firmware<I> {
    fn tool_level(&self, output: Share) -> f32 {
        self.controller.settings().tool_output.level(output)
    }

    fn begin_stream(&mut self, config: &StreamConfig) -> Result<(), StreamError> {
        self.planner.begin_stream(&mut self.controller, config)
    }

    fn take_point(&mut self, n: u16, point: &StreamPoint) {
        self.planner.take_point(&mut self.controller, n, point);
    }

    fn end_stream(&mut self) {
        self.planner.end_stream(StreamReason::Asked);
    }

    fn stream(&self) -> Option<StreamProgress> {
        self.planner.stream().copied()
    }
}

impl<I: DriveInterface> Target<I> for Firmware<I> {
    fn tick(
        &mut self,
        sample: &ArmSample<I::Sample>,
    ) -> Result<(ArmCommand<I::Command>, Status), TargetError> {
        // This call is the host's sign of life.
        self.controller.feed_host_timeout();
        self.planner.run(&mut self.controller);
        let sample = I::sense(&mut self.link, sample);
        let command = self.controller.tick(&sample);
        let command = I::command(&mut self.link, &command);
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
        // A path may wait for bridges that wake up, or for a brake.
        self.planner.is_empty()
            && self.controller.state() == State::Armed
            && self.controller.planning_snapshot().path_left == 0.0
    }
}
