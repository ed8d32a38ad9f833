//! Sessions of a host with the controller, made from bytes: valid and nearly valid orders,
//! garbage between them, silence, hostile samples and faults of the arm. After every tick the
//! [`rules`] are checked, and along accepted paths the [`limits`].
//!
//! The same function serves a property test (random bytes), a fuzzer (bytes chosen by coverage)
//! and a long campaign (a stream of bytes for each seed):
//!
//! ```
//! let report = fivebar_stress::run(&[1, 2, 3])?;
//! assert!(report.ticks > 0);
//! # Ok::<(), fivebar_stress::Violation>(())
//! ```

mod arm;
mod bytes;
mod crossing_arm;
pub mod exploration;
mod kinds;
pub mod limits;
mod orders;
mod points;
mod report;
pub mod rules;
mod samples;
mod sections;
mod session;
mod stream;
mod timed;
mod way_out;

pub use kinds::KINDS;
pub use points::{PointsReport, run_points};
pub use report::Report;
pub use rules::Violation;
pub use timed::timed_run;

use session::Session;

/// Most ticks of one session: 2 s.
pub const LONGEST: u32 = 20_000;

/// Runs the session that `bytes` describe, twice: the second time every refused order is replaced
/// by a request of the status. A refused order leaves no trace, so both must give the same
/// outputs, bit by bit.
///
/// # Errors
/// The first rule that is broken, with its tick.
pub fn run(bytes: &[u8]) -> Result<Report, Violation> {
    run_for(LONGEST, bytes)
}

/// As [`run`], with events for at most this many ticks: a fuzzer wants many short sessions.
///
/// # Errors
/// As [`run`].
pub fn run_for(longest: u32, bytes: &[u8]) -> Result<Report, Violation> {
    let mut first = Session::new(bytes, None);
    first.run(longest)?;
    let (report, outputs, refusals) = first.finish();
    if refusals.iter().any(|&refused| refused) {
        let mut second = Session::new(bytes, Some(refusals));
        second.run(longest)?;
        let (_, without, _) = second.finish();
        let differs = outputs.iter().zip(&without).position(|(a, b)| a != b);
        if let Some(tick) = differs {
            return Err(Violation::new(
                tick as u32,
                "a refused order changes nothing",
                format_args!("{:?} with it, {:?} without", outputs[tick], without[tick]),
            ));
        }
    }
    Ok(report)
}

/// Pseudo-random bytes of a seed (SplitMix64), for campaigns without a fuzzer.
pub fn bytes_of(seed: u64, length: usize) -> Vec<u8> {
    let mut state = seed;
    let words = std::iter::repeat_with(|| {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    });
    words.flat_map(u64::to_le_bytes).take(length).collect()
}
