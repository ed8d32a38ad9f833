//! The sender's path: the moves that wait, and those in the controller's queue.

use fivebar_firmware::Status;
use fivebar_firmware::safety::State;
use fivebar_sim::path_queue::{PathQueue, Shares};

/// The sender's path and how far the controller is with it.
pub(super) struct PathState {
    /// The moves that are not done.
    pub(super) queue: PathQueue,
    /// Whether they are a jog.
    pub(super) is_jog: bool,
    /// Free entries of the controller's queue, by its latest reply.
    pub(super) free: u8,
    /// The most entries that have been free: all of them.
    most_free: u8,
    /// The tick in which all moves were found done.
    idle_since: Option<u32>,
}

impl PathState {
    /// No path, for a controller with so many free entries.
    pub(super) fn new(free: u8) -> Self {
        Self {
            queue: PathQueue::default(),
            is_jog: false,
            free,
            most_free: free,
            idle_since: None,
        }
    }

    /// Records that the controller has accepted the next move and has so many free entries left.
    pub(super) fn accept(&mut self, free: u8) {
        self.free = free;
        self.idle_since = None;
        self.queue.accept();
    }

    /// Drops all moves.
    pub(super) fn drop_moves(&mut self) {
        self.queue.clear();
        self.is_jog = false;
        self.idle_since = None;
    }

    /// Whether the controller has done all its moves. Between two ticks its queue may be empty
    /// although its last segment has not begun, so this must hold in two different ticks.
    pub(super) fn is_idle(&mut self, status: &Status) -> bool {
        self.most_free = self.most_free.max(self.free);
        if status.state != State::Armed || self.free != self.most_free {
            self.idle_since = None;
            return false;
        }
        *self.idle_since.get_or_insert(status.tick) != status.tick
    }

    /// Records that the controller has done all its moves.
    pub(super) fn finish(&mut self) {
        self.queue.finish();
        self.is_jog &= !self.queue.is_accepted();
    }

    /// Changes the shares of speed and power of the moves that wait.
    pub(super) fn change_shares(&mut self, change: impl FnOnce(&mut Shares)) {
        let mut shares = self.queue.shares();
        change(&mut shares);
        self.queue.set_shares(shares);
    }
}
