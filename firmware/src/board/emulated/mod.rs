//! The emulated board: a Cortex-M4F without sensors or bridges, whose ticks the host steps. `image.rs` is the
//! program.

pub mod instructions;
