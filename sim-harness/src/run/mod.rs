//! Runs: the simulated arm, connections to a controller, and jobs on both.

pub mod crossing;
pub mod drive;
pub mod excitation;
pub(crate) mod held;
pub mod link;
pub(crate) mod measured_pose;
pub(crate) mod segment;
pub mod simulation;
pub mod time_optimal;
