//! What jobs ask of an arm at home, and how a session ends.

mod approach;
mod session;
