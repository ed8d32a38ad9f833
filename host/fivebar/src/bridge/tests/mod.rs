//! The sender slot with a simulated arm, without sockets and without a clock: each test says when a byte comes
//! and when time passes.

mod connections;
mod control;
mod lines;
mod page;
mod rig;
mod shares;
mod stops;
