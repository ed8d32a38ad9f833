//! An arm that gives way: a hand leads it, and what it tells is the record; or a program's points are the ends of its springs.

use super::stream::{Given, ended};
use super::{Controlled, Drive, DriveError};
use crate::streaming::SetPoint;
use fivebar_firmware::motion::{StreamConfig, StreamMode, StreamPoint, StreamPolicy};
use fivebar_firmware::planner::StreamPhase;
use fivebar_firmware::protocol::StreamState;

/// Time between two states of the arm [s].
pub const LED_PERIOD: f64 = 0.01;

impl<C: Controlled> Drive<'_, C> {
    /// Lets a hand lead an arm that is held, until `each` returns false of a state of the arm, or the user stops it. States come
    /// [`LED_PERIOD`] apart. Then the arm is held where it is.
    ///
    /// # Errors
    /// The controller refuses, holds the arm, or has a fault; or a failed connection.
    pub fn be_led(
        &mut self,
        tick_rate: f64,
        each: &mut dyn FnMut(&StreamState) -> bool,
    ) -> Result<(), DriveError> {
        let period = (LED_PERIOD * tick_rate).round().clamp(1.0, 1e4) as u16;
        let config = StreamConfig {
            id: self.fault_free_status()?.tick,
            mode: StreamMode::Free,
            period,
            delay: 2 * period,
            policy: StreamPolicy::Stop,
        };
        self.begin_when_free(config)?;
        let led = self.record(config.id, each);
        if led.is_err() {
            self.bring_to_rest()?;
            return led;
        }
        self.end_stream(StreamPolicy::Stop)
    }

    fn record(
        &mut self,
        id: u32,
        each: &mut dyn FnMut(&StreamState) -> bool,
    ) -> Result<(), DriveError> {
        let mut n = 0_u16;
        loop {
            n = n.wrapping_add(1);
            let point = StreamPoint {
                id,
                due: 0,
                position: (0.0, 0.0),
                velocity: (0.0, 0.0),
                force: (0.0, 0.0),
            };
            self.controller.client().send_point(n, &point)?;
            self.controller.pass_time()?;
            while let Some(state) = self.controller.client().take_stream_state() {
                if state.progress.id != id {
                    continue;
                }
                if let StreamPhase::Ends | StreamPhase::Ended = state.progress.phase {
                    self.fault_free_status()?;
                    return Err(ended(Some(state)));
                }
                if !each(&state) {
                    return Ok(());
                }
            }
            if (self.wants_stop)() {
                return Ok(());
            }
        }
    }

    /// Sends the points of a program to an arm with an impedance, each a period after the one before, until it ends the stream.
    /// Where it gives none the arm is damped, and then held.
    pub(super) fn feel(
        &mut self,
        config: &StreamConfig,
        given: &mut dyn FnMut() -> Given,
    ) -> Result<(), DriveError> {
        let mut tick = self.fault_free_status()?.tick;
        let (mut due, mut n) = (tick, 0_u16);
        loop {
            if (self.wants_stop)() {
                return Err(DriveError::Stopped(None));
            }
            if let Some(state) = self.latest_state() {
                tick = state.tick;
                if let StreamPhase::Ends | StreamPhase::Ended = state.progress.phase {
                    self.fault_free_status()?;
                    return Err(ended(Some(state)));
                }
            }
            if (tick.wrapping_sub(due) as i32) < 0 {
                self.controller.pass_time()?;
                continue;
            }
            match given() {
                Given::Point(point) => {
                    n = n.wrapping_add(1);
                    let point = spring_end(config.id, &point);
                    self.controller.client().send_point(n, &point)?;
                    due = due.wrapping_add(config.period.into());
                    // A program that is later than the delay goes on from now.
                    if tick.wrapping_sub(due) as i32 > config.delay.into() {
                        due = tick;
                    }
                }
                Given::Spring(impedance) => self.set_impedance(config, impedance)?,
                Given::Nothing => self.controller.pass_time()?,
                Given::End => return Ok(()),
            }
        }
    }
}

/// A program's point as the end of a spring, which rests if no velocity is given.
fn spring_end(id: u32, point: &SetPoint) -> StreamPoint {
    let single = |values: [f64; 2]| values.map(|value| value as f32).into();
    StreamPoint {
        id,
        due: 0,
        position: single(point.position),
        velocity: single(point.velocity.unwrap_or_default()),
        force: single(point.force),
    }
}
