//! Helpers that the tests of several crates share. It is a development dependency only and part
//! of no program.

mod camera;
mod child;
mod compare;
mod poses;
mod tally;

pub use camera::{Camera, Paper, circle};
pub use child::{Running, program};
pub use compare::{assert_close, distance, turned};
pub use poses::{Case, Moving, geometry, mode, moving, pose, side};
pub use tally::Tally;
