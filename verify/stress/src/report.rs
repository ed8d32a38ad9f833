//! What happened in sessions.

use crate::kinds::KINDS;
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
    /// Ticks along streams.
    pub streamed: u32,
    /// Settings that were applied, and refused.
    pub settings: [u32; 2],
    /// Sessions in which a fault was latched.
    pub faults: u32,
    /// Commands of each of the [`KINDS`](crate::KINDS), done or refused.
    pub kinds: [u32; KINDS.len()],
    /// Crossings that were accepted.
    pub crossings: u32,
    /// Sessions whose end had a way out to motion, and to a named reason.
    pub ways_out: [u32; 2],
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
            streamed: self.streamed + other.streamed,
            settings: sum(self.settings, other.settings),
            faults: self.faults + other.faults,
            kinds: std::array::from_fn(|kind| self.kinds[kind] + other.kinds[kind]),
            crossings: self.crossings + other.crossings,
            ways_out: sum(self.ways_out, other.ways_out),
            reached: self.reached.max(other.reached),
        }
    }
}
