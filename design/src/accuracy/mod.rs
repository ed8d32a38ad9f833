//! Accuracy: how far real lengths, inputs and joint clearances take a mechanism from its
//! ideal, in position, motion and force (Shi 2005, Tu 2005; sections 6 and 4).
//!
//! Two unlike ways to every sensitivity: the analytic matrices of [`loops`], and dual
//! numbers through any model that implements [`DifferentiableModel`].

pub mod allocation;
pub mod arm;
pub mod clearance_equilibrium;
mod differentiate;
pub mod dyad_loops;
mod error;
pub mod five_bar;
pub mod linkage;
pub mod loops;
mod propagation;
pub mod slider;

pub use differentiate::{DifferentiableModel, sensitivities};
pub use error::AccuracyError;
pub use propagation::{Primitive, Scatter};
