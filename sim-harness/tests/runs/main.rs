//! What jobs ask of an arm at home.

mod approach;
