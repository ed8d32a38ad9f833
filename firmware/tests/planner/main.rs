//! The planner with the controller that follows its paths.

#[path = "../shared/rig.rs"]
mod rig;

mod planned_limits;
mod planning;
mod refusals;
mod short_lines;
mod timed;
