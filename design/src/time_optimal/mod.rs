//! Time-optimal motion along a path under limits of torque, speed and acceleration.
//!
//! [`demand`](DrivenArm::demand) gives the coefficients of the limits at a place, the passes the
//! greatest speed along the path, [`plan`] a run from rest to rest.

mod averages;
mod blend;
mod demand;
mod grid;
mod jerk;
mod job_path;
mod limits;
mod passes;
mod path;
mod run;
mod spline;
mod timed;
mod turning;

pub use blend::blend;
pub use demand::{Demand, DrivenArm, PlannedDrive};
pub use job_path::{JobPath, PathPart};
pub use limits::PlanLimits;
pub use path::{FourierSeries, PathPiece, PathPoint};
pub use run::{PlanError, Run, RunSample, plan};
pub use timed::{TimedPiece, TimedRun, plan_timed};
