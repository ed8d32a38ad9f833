//! What the tests of several crates share. A development dependency only: no program
//! contains it.

mod tally;

pub use tally::Tally;
