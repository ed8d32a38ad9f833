//! Accuracy: the effect of errors of lengths and inputs, and of joint clearances, on
//! positions, motion and forces of a mechanism (Shi 2005, Tu 2005).
//!
//! Every sensitivity can be computed by two independent methods: the analytic matrices of
//! [`loops`], and by dual numbers through any model that implements [`DifferentiableModel`].

pub mod allocation;
pub mod arm;
pub mod clearance_equilibrium;
mod corners;
mod differentiate;
pub mod dyad_loops;
mod error;
pub mod five_bar;
pub mod linkage;
pub mod loops;
mod propagation;
mod sampling;
pub mod slider;

pub use differentiate::{DifferentiableModel, sensitivities};
pub use error::{AccuracyError, AnalysisError};
pub use propagation::{Primitive, Scatter};
pub use sampling::{Deviations, Moments, Progress, Sampling};
