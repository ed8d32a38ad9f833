//! What the edges of a bridge do to the samples of its current.
//!
//! The output of a bridge switches later than its input: a DRV8874 takes 0.65 µs, and 0.3 µs of dead
//! time and 0.15 µs of slope more, by the sign of the current (SLVSF66, 6.5, typical). The amplifier in the
//! motor's lead sees the edge as a step of its common mode, and forgets it with its bandwidth. An INA241A also
//! holds its output for 1 µs after an edge, which is not simulated: docs/use/wiring.md, Sampling.

use crate::time::{MICROSECOND, Time};
use crate::wiring::Edges;

/// The delays of a bridge, from its input to the end of the edge at its output: a quick part, and a
/// slow one with its dead time.
pub const BRIDGE_DELAYS: [Time; 2] = [4 * MICROSECOND / 10, 15 * MICROSECOND / 10];
/// How far a sample is off that is taken as the output switches [codes].
const STEP: f64 = 400.0;
/// The time constant of an INA241A, 1.1 MHz.
const TIME_CONSTANT: Time = 145 * MICROSECOND / 1000;

/// By how many codes the edges change a sample of the current, with this delay of the bridge.
pub(crate) fn ringing(edges: &Edges, delay: Time) -> u16 {
    let since = edges
        .iter()
        .flatten()
        .filter_map(|age| age.checked_sub(delay));
    let left = since.map(|since| (-(since as f64) / TIME_CONSTANT as f64).exp());
    (STEP * left.sum::<f64>()) as u16
}
