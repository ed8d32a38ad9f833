//! Geometric calibration: lengths, joint offsets and placement of an arm from a plate with known
//! holes; lengths and offsets also from distances, unknown holes and photographs
//! ([`calibrate_mixed`]).
//!
//! Unknown are p = (l1…l5, δ1, δ4, x, y, φ): a joint's angle is θi = encoder angle + δi, and the
//! tip on the plate T = R(φ) C(θ1, θ4; l) + (x, y). The tip is put into holes P_k, and the
//! residuals r_k = T(p, encoder angles) − P_k, two rows a hole, are made least, by the sum of
//! their squares or of Huber's loss. A base of exactly zero has no direction: l5 and φ are then held at zero ([`Unknowns`]).
//!
//! ```
//! use fivebar_design::calibration::{Criterion, Parameters, Plate, Touch, calibrate};
//! use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
//! use nalgebra::Vector2;
//!
//! let drawn = [0.10, 0.16, 0.16, 0.10, 0.08]; // m
//! let made = Geometry::new([0.1001, 0.1598, 0.1603, 0.0999, 0.0802])?;
//! let mode = WorkingMode::new(Side::Right, Side::Left);
//! let offsets = [0.01, -0.02]; // rad
//! let mut touches = Vec::new();
//! for x in [-0.05, -0.01, 0.04, 0.09, 0.13] {
//!     for y in [0.14, 0.17, 0.20] {
//!         let hole = Vector2::new(x, y); // the plate lies in the arm's own frame
//!         let [theta1, _, _, theta4] = made.inverse(hole, mode)?.angles();
//!         touches.push(Touch { encoder: [theta1 - offsets[0], theta4 - offsets[1]], hole });
//!     }
//! }
//! let plate = Plate { touches, assembly: Side::Left, sigma: 20e-6, criterion: Criterion::Huber };
//! let found = calibrate(&plate, drawn)?;
//! assert!((found.parameters.offsets[0] - 0.01).abs() < 1e-9);
//! assert!((found.parameters.lengths[2] - 0.1603).abs() < 1e-9);
//! assert!(found.rejected.is_empty());
//! # let _: Parameters = found.parameters;
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```

mod error;
mod legs;
mod measurements;
mod mixed;
mod observability;
mod parameters;
mod plate;
mod poses;
mod start;
mod tip;
mod tip_error;
mod unknowns;

pub use error::CalibrationError;
pub use measurements::{
    Bar, Criterion, Deviations, HoleTouch, Measurements, PhotoPoint, Plate, Touch,
};
pub use mixed::{KindResult, MixedCalibration, calibrate_mixed};
pub use parameters::{PARAMETER_NAMES, Parameters};
pub use plate::{Calibration, calibrate};
pub use poses::{Proposal, propose};
pub use start::rigid;
pub use tip::{Tip, tip};
pub use tip_error::{TipError, tip_error, tip_error_before, tip_error_best_placed};
pub use unknowns::Unknowns;
