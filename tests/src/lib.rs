//! Truths that cross the crates of Fivebar; see `tests/`.

pub mod vectors;
