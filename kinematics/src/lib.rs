//! Kinematics, dynamics, control and trajectories of the planar five-bar arm, in closed form.
//!
//! Two driven base joints A and E, a closed loop A–B–C–D–E, the tool at C. SI units,
//! absolute angles counter-clockwise from +x; the letters and signs are drawn in
//! `docs/notation.md` at the root of the repository.
//!
//! Everything is generic over [`Scalar`]: `f32` on the microcontroller, `f64` on a desktop.
//! It neither allocates nor panics. What is asked only before there is an arm is in the
//! crate `fivebar-design`.
#![no_std]

pub mod control;
pub mod dynamics;
pub mod five_bar;
pub mod scalar;
pub mod trajectory;
mod vector;

/// The vectors and matrices of every signature here.
pub use nalgebra;
pub use scalar::Scalar;
pub use vector::PlanarVector;
