//! Where the tip was worst while a job was drawn.

/// The greatest tip error of some ticks, and where it was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WorstError {
    /// The error [m]; infinite if a position was not a number.
    pub error: f64,
    /// Time from the beginning of the job [s].
    pub time: f64,
    /// Tag of the move: the line of the job.
    pub line: u32,
}

impl WorstError {
    /// The worse of both.
    pub(super) fn or(self, other: Self) -> Self {
        let is_worse = other.error > self.error || other.error.is_nan();
        match is_worse {
            true if other.error.is_nan() => Self {
                error: f64::INFINITY,
                ..other
            },
            true => other,
            false => self,
        }
    }
}

/// The tip while a job was drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drawing {
    /// The worst error with the tool down; none if it was never down.
    pub down: Option<WorstError>,
    /// The worst error of the whole job.
    pub whole: WorstError,
    /// The error in the last tick of the job.
    pub end: WorstError,
    /// Greatest speed of the reference with the tool down [m/s].
    pub speed: f64,
}
