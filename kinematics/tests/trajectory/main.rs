//! Trajectories as a whole: what is accepted, how fast it may go, and the motion that
//! comes of it.

mod common;
mod loads;
mod lookahead;
mod refusals;
mod validation;
