//! A run: what happened in it, and what it comes to.

mod csv;
mod summary;
mod trace;

pub use summary::{Summary, TipError};
pub use trace::{Sample, Trace};
