//! Kinematics, dynamics and control of the planar five-bar arm, in closed form.
//!
//! Two driven base joints A and E, a closed loop A–B–C–D–E, the tool at C. SI units,
//! absolute angles counter-clockwise from +x; the letters and signs are drawn in
//! `docs/notation.md` at the root of the repository.
//!
//! Everything the controller runs is generic over [`Scalar`]: `f32` on the
//! microcontroller, `f64` on a desktop, dual numbers for sensitivities. It neither
//! allocates nor panics. The design-time analyses stand behind the feature `design`.
#![no_std]
#[cfg(feature = "design")]
extern crate std;

#[cfg(feature = "design")]
pub mod accuracy;
pub mod control;
pub mod dynamics;
pub mod five_bar;
#[cfg(feature = "design")]
pub mod linkage;
#[cfg(feature = "design")]
pub mod mobility;
pub mod scalar;
#[cfg(feature = "design")]
pub mod slider;
pub mod trajectory;
mod vector;
#[cfg(feature = "design")]
pub mod workspace;

pub use scalar::Scalar;
pub use vector::Vec2;
