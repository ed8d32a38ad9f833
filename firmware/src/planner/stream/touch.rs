//! Streams of the modes Free and Impedance: the arm gives way while points come.

use super::{Planner, Stream, StreamError, StreamMode, StreamPhase, StreamPoint, StreamReason};
use crate::controller::{ArmController, Hold, TouchError, TouchPhase};
use crate::drives::Drives;
use crate::safety::State;
use rtic_core::Mutex;

impl From<TouchError> for StreamError {
    fn from(error: TouchError) -> Self {
        match error {
            TouchError::NoTorque => Self::NoTorque,
            TouchError::Belts => Self::Belts,
            TouchError::LateTorque => Self::LateTorque,
            TouchError::Moving => Self::Moving,
        }
    }
}

impl Planner {
    /// Lets a held arm give way in this mode.
    pub(super) fn begin_touch(
        &self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        hold: Option<Hold>,
        mode: &StreamMode,
    ) -> Result<(), StreamError> {
        let rendering = match mode {
            StreamMode::Joint | StreamMode::Tip => return Ok(()),
            StreamMode::Free => None,
            StreamMode::Impedance(impedance) => {
                controller.lock(|controller| controller.check_touch())?;
                let tool = &self.envelope.workspace.tool;
                let held = hold
                    .and_then(|hold| Some((hold.tool(tool, self.assembly)?, hold.joints())))
                    .ok_or(StreamError::Moving)?;
                let rendering = self.rendering(controller, held, impedance)?;
                self.store_fixtures(controller);
                Some(rendering)
            }
        };
        controller.lock(|controller| controller.begin_touch(rendering.as_ref()))?;
        Ok(())
    }

    /// Lets the arm give way by a point.
    pub(super) fn feed_touch(
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        stream: &Stream,
        n: u16,
        point: &StreamPoint,
    ) -> Result<(), StreamReason> {
        if !stream.is_next(n) {
            return Err(StreamReason::Order);
        }
        if stream.config.mode.renders() && !point.is_finite() {
            return Err(StreamReason::Number);
        }
        let goes_on = controller.lock(|controller| controller.feed_touch(point));
        goes_on.then_some(()).ok_or(StreamReason::Stopped)
    }
}

impl Stream {
    /// Looks whether the arm still gives way, and ends that with the stream.
    pub(super) fn watch_touch(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        state: State,
    ) {
        let (phase, tick) =
            controller.lock(|controller| (controller.touch_phase(), controller.ticks()));
        if let Some(change) = &self.change
            && change.go_on(controller, tick)
        {
            self.change = None;
        }
        match phase {
            Some(TouchPhase::Ends) => self.end(StreamReason::Stopped),
            Some(_) if self.progress.phase == StreamPhase::Ends => {
                controller.lock(ArmController::end_touch);
            }
            Some(TouchPhase::Damps) => self.progress.phase = StreamPhase::Starved,
            Some(TouchPhase::Yields) => {}
            None => {
                let silent = state == State::Armed && self.progress.phase == StreamPhase::Starved;
                self.end(if silent {
                    StreamReason::Silent
                } else {
                    StreamReason::Stopped
                });
                self.progress.phase = StreamPhase::Ended;
            }
        }
    }
}
