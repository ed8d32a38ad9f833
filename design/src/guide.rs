//! Where to begin, by what is built. Documentation only.
//!
//! # A leg
//!
//! Which torques hold a force of the foot? `τ = Jᵀ F`:
//!
//! ```
//! use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
//! use nalgebra::Vector2;
//!
//! // Thighs and shanks of 90 and 160 mm, coaxial motors; the foot is 180 mm below them.
//! let leg = Geometry::new([0.09_f64, 0.16, 0.16, 0.09, 0.0])?;
//! let pose = leg.inverse(Vector2::new(0.0, -0.18), WorkingMode::new(Side::Left, Side::Right))?;
//! let [tau1, tau4] = leg.jacobian(&pose)?.matrix().tr_mul(&Vector2::new(0.0, 20.0)).into(); // 20 N upwards
//! assert!((tau1 + tau4).abs() < 1e-9 && tau1.abs() < 2.0, "{tau1} {tau4} N·m");
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! [`synthesis`](crate::synthesis) finds its lengths, [`servo`](crate::servo) the margins of its position loop.
//!
//! # A plotter
//!
//! Is an arm free of singularities on a sheet? The proof is by interval arithmetic:
//!
//! ```
//! use fivebar_design::synthesis::{Area, Proof, prove};
//!
//! // A sheet of 100 by 50 mm, whose lower side is 140 mm before the middle of the base.
//! let sheet = Area::Rectangle { aspect: 2.0 };
//! let arm = [0.10, 0.16, 0.16, 0.10, 0.08];
//! assert_eq!(prove(arm, &sheet, 0.1, [0.0, 0.14]), Proof::Proved);
//! assert!(matches!(prove(arm, &sheet, 0.3, [0.0, 0.14]), Proof::Refuted(_)));
//! ```
//!
//! [`workspace`](crate::workspace) maps what is left of the reach, [`accuracy`](crate::accuracy) says how exact the lines are,
//! [`time_optimal`](crate::time_optimal) how fast.
//!
//! # A calibrator
//!
//! [`calibration`](crate::calibration) finds the lengths of the arm that was built; its example touches fifteen holes.
//! [`propose`](crate::calibration::propose) says which poses tell the most. What a photograph of a drawing shows is in [`photo`](crate::photo), masses and
//! friction are in [`identification`](crate::identification).
