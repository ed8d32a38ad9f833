//! What the session does for a stream of set-points besides handing its points over.

use super::Session;
use crate::controller::ArmController;
use crate::drives::{BrushedCommand, Drives};
use crate::motion::{Fixture, StreamConfig};
use crate::planner::Planner;
use crate::planner::StreamPhase;
use crate::protocol::{CommandError, ControllerMessage, Frame, Reply, StreamState, encode};
use rtic_core::Mutex;

impl Session {
    /// Begins a stream; its state is sent each period from now on.
    pub(super) fn begin_stream<C>(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        planner: &mut Planner,
        config: &StreamConfig,
    ) -> Result<Reply<C>, CommandError> {
        planner
            .begin_stream(controller, config)
            .map_err(CommandError::Stream)?;
        let tick = controller.lock(|controller| controller.ticks());
        self.stream_sampler.begin(config.period, tick);
        Ok(Reply::Done)
    }

    /// The state of the stream that is due, if one is. That of a stream that has ended is the last one.
    pub(super) fn stream_state(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        planner: &Planner,
    ) -> Option<Frame> {
        let progress = *planner.stream()?;
        let sample = controller.lock(|controller| controller.stream_sample());
        self.stream_sampler.due(sample.tick)?;
        if progress.phase == StreamPhase::Ended {
            self.stream_sampler = super::Sampler::off();
        }
        encode(&ControllerMessage::<BrushedCommand>::Stream(StreamState {
            tick: sample.tick,
            progress,
            buffered: planner.buffered(sample.tick),
            angle: sample.angle,
            velocity: sample.velocity,
            torque: sample.torque,
        }))
    }
}

/// Changes a wall or a guide of the next stream with an impedance.
pub(super) fn set_fixture<C>(
    planner: &mut Planner,
    place: u8,
    fixture: Option<Fixture>,
) -> Result<Reply<C>, CommandError> {
    let changed = planner.set_fixture(place, fixture);
    changed.map_err(CommandError::Stream)?;
    Ok(Reply::Done)
}
