//! Simulated time.

/// Time since power-up [fs]. 64 bits last for five hours.
pub type Time = u64;

/// A time that does not come.
pub const NEVER: Time = u64::MAX;
/// One microsecond.
pub const MICROSECOND: Time = 1_000_000_000;
/// One millisecond.
pub const MILLISECOND: Time = 1000 * MICROSECOND;
/// One second.
pub const SECOND: Time = 1000 * MILLISECOND;

/// The period of a frequency [Hz], rounded to a femtosecond.
pub fn period(frequency: f64) -> Time {
    (SECOND as f64 / frequency).round() as Time
}

/// Time in seconds.
pub fn seconds(time: Time) -> f64 {
    time as f64 / SECOND as f64
}
