//! An arm that a hand leads: its points keep it so, and what it tells is the record.

use super::{Controlled, Drive, DriveError};
use fivebar_firmware::motion::{StreamConfig, StreamMode, StreamPoint};
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
        };
        self.begin_when_free(config)?;
        let led = self.record(config.id, each);
        if led.is_err() {
            self.bring_to_rest()?;
            return led;
        }
        self.end_stream()
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
                    return Err(super::stream::ended(Some(state)));
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
}
