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
//! Which holes of a plate tell the most of an arm, and which lengths has the one that was built?
//!
//! ```
//! use fivebar_design::calibration::{Criterion, Plate, Touch, calibrate, propose};
//! use fivebar_kinematics::five_bar::{Geometry, PoseError, Side, Tool, WorkingMode, Workspace};
//! use nalgebra::Vector2;
//!
//! let drawn = Geometry::new([0.10, 0.16, 0.16, 0.10, 0.08])?;
//! let mode = WorkingMode::new(Side::Right, Side::Left);
//! let tool = Tool::new(drawn, Vector2::zeros())?;
//! let workspace = Workspace { tool, mode, limits: None, margin: 0.3 };
//! let home = drawn.inverse(Vector2::new(0.04, 0.18), mode)?;
//! let holes = propose(&workspace, &home, 12).ok_or("too few poses")?.points;
//!
//! // The encoders' angles with the tip in each hole; here those of an arm that was made a little wrong.
//! let made = Geometry::new([0.1001, 0.1598, 0.1603, 0.0999, 0.0802])?;
//! let touch = |&hole: &Vector2<f64>| {
//!     let [theta1, _, _, theta4] = made.inverse(hole, mode)?.angles();
//!     Ok(Touch { encoder: [theta1, theta4], hole })
//! };
//! let touches = holes.iter().map(touch).collect::<Result<_, PoseError>>()?;
//!
//! let plate = Plate { touches, assembly: home.assembly(), sigma: 20e-6, criterion: Criterion::LeastSquares };
//! let found = calibrate(&plate, drawn.lengths())?.parameters;
//! assert!((found.lengths[2] - 0.1603).abs() < 1e-9, "{:?}", found.lengths);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! [`calibration`](crate::calibration) also takes distances, unknown holes and photographs. What a photograph of a drawing
//! shows is in [`photo`](crate::photo), masses and friction are in [`identification`](crate::identification).
