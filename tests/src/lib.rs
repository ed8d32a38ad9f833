//! Tests that need several crates of Fivebar, or its firmware images; see `tests/`.

pub mod vectors;
