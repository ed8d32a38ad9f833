//! What happened in sessions.

use crate::limits::Reached;

/// What happened in a session.
#[derive(Clone, Copy, Debug, Default)]
pub struct Report {
    /// Ticks.
    pub ticks: u32,
    /// Ticks with power.
    pub powered: u32,
    /// Commands that were done, and refused.
    pub commands: [u32; 2],
    /// Moves that were accepted, and refused.
    pub moves: [u32; 2],
    /// Timed moves among them.
    pub timed: [u32; 2],
    /// Settings that were applied, and refused.
    pub settings: [u32; 2],
    /// Sessions in which a fault was latched.
    pub faults: u32,
    /// The limits of accepted paths.
    pub reached: Reached,
}

impl Report {
    /// The sums of both.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        let sum = |[a, b]: [u32; 2], [c, d]: [u32; 2]| [a + c, b + d];
        Self {
            ticks: self.ticks + other.ticks,
            powered: self.powered + other.powered,
            commands: sum(self.commands, other.commands),
            moves: sum(self.moves, other.moves),
            timed: sum(self.timed, other.timed),
            settings: sum(self.settings, other.settings),
            faults: self.faults + other.faults,
            reached: self.reached.max(other.reached),
        }
    }
}
