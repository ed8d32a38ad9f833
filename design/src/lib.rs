//! Analyses for the design of an arm. They run on the desktop, never on the target.
//!
//! - [`linkage`]: planar linkages as chains of Assur dyads: positions, motions, forces.
//! - [`slider`]: the slider-driven mechanism, two sliders on one guide that carry a platform.
//! - [`mobility`]: degrees of freedom by screw theory.
//! - [`accuracy`]: sensitivities, tolerances and clearances.
//! - [`workspace`]: maps of the branches, singularity curves, free rectangles.
//!
//! The arm itself is in the crate `fivebar-kinematics`. Letters, frames and signs are drawn
//! in `docs/notation.md` at the root of the repository.

pub mod accuracy;
mod dual;
pub mod linkage;
pub mod mobility;
pub mod slider;
pub mod workspace;

pub use dual::Dual;
