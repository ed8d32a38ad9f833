//! New against worn: one job done by the same arm with ideal joints and with joints of ever
//! greater clearance, beside what the models without contact foretell.

mod answer;
mod prediction;
mod study;

pub use answer::answer;
pub use prediction::Prediction;
pub use study::{Outcome, Study, study};

/// The joints by name, in the order of everything here.
pub const NAMES: [&str; 5] = ["A", "B", "C", "D", "E"];
