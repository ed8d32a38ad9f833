//! The emulated board: a Cortex-M4F without sensors or motors, whose ticks the host steps. There is an image for each kind
//! of drives: `brushed.rs`, `stepper.rs` and `can.rs` say which, and `program.rs` is their program.

pub mod instructions;
pub mod lockstep;
