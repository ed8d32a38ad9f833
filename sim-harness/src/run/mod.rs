//! What is run: the simulated arm, ways to a controller, and jobs done by both.

pub mod contact;
pub mod drive;
pub mod link;
pub mod plant;
pub mod simulation;
