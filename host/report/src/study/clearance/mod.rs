//! The study of wear: the same arm does one job with ideal joints and with greater and
//! greater clearances. The results stand beside the predictions of models without contact.

mod answer;
mod prediction;
mod study;

pub use answer::answer;
pub use prediction::Prediction;
pub use study::{ClearanceStudy, ClearanceStudyError, Outcome, study};

/// The names of the joints, in the order of all arrays here.
pub const NAMES: [&str; 5] = ["A", "B", "C", "D", "E"];
