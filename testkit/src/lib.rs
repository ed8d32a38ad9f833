//! What the tests of several crates share. A development dependency only: no program
//! contains it.

mod compare;
mod poses;
mod tally;

pub use compare::{assert_close, distance, turned};
pub use poses::{Case, Moving, geometry, mode, moving, pose, side};
pub use tally::Tally;
