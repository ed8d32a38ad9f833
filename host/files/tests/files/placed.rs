//! G-code read as it is written: neither moved nor scaled nor turned.

use fivebar_files::job::{GcodeError, Job, JobError, Placement};

pub(crate) const AS_WRITTEN: Placement = Placement {
    origin: [0.0, 0.0],
    scale: 1.0,
    turn: 0.0,
    home: [0.05, 0.2],
};

pub(crate) fn job(text: &str) -> Job {
    Job::parse(text, &AS_WRITTEN).unwrap_or_else(|refusal| panic!("{text}\n{refusal}"))
}

/// The number of the refused line, and the reason.
pub(crate) fn refusal(text: &str) -> (u32, GcodeError) {
    match Job::parse(text, &AS_WRITTEN) {
        Err(JobError::Line { line, reason, .. }) => (line, reason),
        other => panic!("{text:?} gave {other:?}"),
    }
}
