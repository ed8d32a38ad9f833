//! Time-optimal runs against another method, and under changes of arm and path whose effect is
//! known.

mod bang_bang;
mod law;
mod long_runs;
mod scaling;
mod shared;
