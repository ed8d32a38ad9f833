//! The log over the debug probe: transitions and faults by name, and how long the tick takes.
//!
//! The idle task logs what has changed since its last round, so the log costs the tick no
//! instructions. A round takes up to a few milliseconds; of several transitions within one, the
//! log shows the first state and the last.
//!
//! No line waits for a probe or masks interrupts, whatever a probe does or leaves behind. A probe
//! sets the channel's mode in RAM to "block if full", and the mode stays when it goes away. With
//! the feature `disable-blocking-mode`, `defmt-rtt` does not read the mode when it writes a line:
//! a line for which the buffer has no room is dropped. With `drop-on-contention` an atomic flag
//! guards the buffer in place of a critical section. Only `defmt::flush` still waits for a probe,
//! so nothing here calls it.

use super::cycles::TickTimes;
use crate::ArmController;
use crate::drives::Drives;
use crate::safety::{Fault, State};
use rtic_core::Mutex;

/// Ticks between two lines about the tick's duration.
const TIMING_EVERY: u32 = 10_000;

/// What was logged last.
pub struct EventLog {
    state: State,
    fault: Option<Fault>,
    /// Tick of the last line about the tick's duration.
    timing: u32,
}

impl EventLog {
    /// The log of a new controller.
    pub const fn new() -> Self {
        Self {
            state: State::Stopped,
            fault: None,
            timing: 0,
        }
    }

    /// Logs what has changed since the last call.
    pub fn update(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        times: &TickTimes,
    ) {
        let (tick, state, latched) = controller.lock(|controller| {
            let latched = controller
                .fault()
                .map(|snapshot| (snapshot.fault, snapshot.tick));
            (controller.ticks(), controller.state(), latched)
        });
        if state != self.state {
            defmt::info!("tick {=u32}: {} to {}", tick, self.state, state);
            self.state = state;
        }
        let fault = latched.map(|(fault, _)| fault);
        if fault != self.fault {
            if let Some((fault, raised)) = latched {
                defmt::error!(
                    "tick {=u32}: fault {=u8}, {}",
                    raised,
                    fault.number(),
                    fault
                );
            }
            self.fault = fault;
        }
        if tick.wrapping_sub(self.timing) >= TIMING_EVERY {
            let (last, longest) = times.last_and_longest();
            defmt::info!("the tick: {=u32} cycles, at most {=u32}", last, longest);
            self.timing = tick;
        }
    }
}

impl Default for EventLog {
    fn default() -> Self {
        Self::new()
    }
}
