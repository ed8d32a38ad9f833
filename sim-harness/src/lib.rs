//! Simulate, check and drive a planar five-bar arm: the library behind `fivebar`.
//!
//! Each group uses those below it and none above.
//!
//! | group | what it holds |
//! |---|---|
//! | [`show`] | pages, files for other programs, the live page, the command line |
//! | [`study`] | analyses: accuracy, clearance, linkages, mobility, workspace, queries |
//! | [`run`] | the simulated arm, ways to a controller, and jobs done by both |
//! | [`input`] | robots, jobs, scenarios, linkages and mechanisms, read and checked |

pub mod input;
pub mod run;
pub mod show;
pub mod study;
