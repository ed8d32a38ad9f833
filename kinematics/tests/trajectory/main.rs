//! Whole trajectories: which paths are accepted, their motion limits, and the motion.

mod bound;
mod common;
mod loads;
mod lookahead;
mod refusals;
mod smooth;
mod timed;
mod tool_output;
mod validation;
