//! What ends a run before its time, and where in the program.

use crate::violation::Violation;
use std::fmt;

/// Why a run ended before its time.
#[derive(Clone, Debug)]
pub struct Report {
    /// The broken rule.
    pub violation: Violation,
    /// The instruction that made the access; if it is not found, the beginning of its block.
    pub pc: u32,
    /// The function there.
    pub function: String,
    /// The source line there.
    pub line: String,
    /// When [s].
    pub time: f64,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} (at {:#x} in {}, {}, after {:.6} s)",
            self.violation, self.pc, self.function, self.line, self.time
        )
    }
}

impl std::error::Error for Report {}
