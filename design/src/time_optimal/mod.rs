//! Time-optimal motion along a path under limits of torque, speed and acceleration.
//!
//! [`demand`](DrivenArm::demand) gives the coefficients of the limits at a point. Two passes give the greatest
//! speed along the path: backward, what can still stop, and forward, what can be reached.
//! [`plan`] gives a run from rest to rest, [`plan_timed`] one that a controller can follow.

mod averages;
mod blend;
mod demand;
mod error;
mod grid;
mod jerk;
mod job_path;
mod limits;
mod passes;
mod path;
mod plan;
mod run;
mod spline;
mod strip;
mod timed;
mod turning;
mod waypoints;

pub use blend::blend;
pub use demand::{Demand, DrivenArm, PlannedDrive};
pub use error::PlanError;
pub use job_path::{JobPath, PathPart};
pub use limits::{FallingTorque, PlanLimits};
pub use path::{FourierSeries, PathPiece, PathPoint};
pub use plan::plan;
pub use run::{Run, RunSample};
pub use timed::{Smoothing, TimedPiece, TimedRun, plan_timed};
pub use waypoints::Waypoints;
