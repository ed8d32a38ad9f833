//! The planned segments, first in, first out.

use super::ramp::MotionLimits;
use super::trajectory_segment::{Shape, ToolOutput};
use crate::Scalar;

/// A shape and the limits of the motion along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlannedSegment<S> {
    pub(super) shape: Shape<S>,
    /// Where it starts on the shape: the second half of a blend starts in its middle [m].
    pub(super) offset: S,
    /// Length: of a curve [m], of a joint move [rad], of a dwell [s].
    pub(super) length: S,
    /// The part of its end that the next corner may replace [m].
    pub(super) free: S,
    pub(super) limits: MotionLimits<S>,
    /// Greatest speed at its start, at most that of its limits [m/s].
    pub(super) entry: S,
    pub(super) tag: u32,
    pub(super) tool: ToolOutput<S>,
    /// The motion along it must start from rest.
    pub(super) from_rest: bool,
}

/// A ring buffer of planned segments.
#[derive(Clone, Copy, Debug)]
pub(super) struct Queue<S, const N: usize> {
    segments: [Option<PlannedSegment<S>>; N],
    head: usize,
    len: usize,
}

impl<S: Scalar, const N: usize> Queue<S, N> {
    pub(super) const fn new() -> Self {
        const {
            assert!(N >= 4, "a look-ahead of fewer than two moves is none");
        }
        Self {
            segments: [None; N],
            head: 0,
            len: 0,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// The segment `index` places after the first.
    pub(super) fn get(&self, index: usize) -> Option<&PlannedSegment<S>> {
        if index < self.len {
            self.segments.get((self.head + index) % N)?.as_ref()
        } else {
            None
        }
    }

    pub(super) fn first(&self) -> Option<&PlannedSegment<S>> {
        self.get(0)
    }

    pub(super) fn last(&self) -> Option<&PlannedSegment<S>> {
        self.get(self.len.checked_sub(1)?)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &PlannedSegment<S>> {
        (0..self.len).filter_map(|index| self.get(index))
    }

    /// Appends a segment; the caller has checked that a slot is free.
    pub(super) fn push(&mut self, planned: PlannedSegment<S>) {
        if let Some(slot) = self.segments.get_mut((self.head + self.len) % N)
            && self.len < N
        {
            *slot = Some(planned);
            self.len += 1;
        }
    }

    /// Removes all.
    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Removes the first.
    pub(super) fn pop(&mut self) {
        if self.len > 0 {
            self.head = (self.head + 1) % N;
            self.len -= 1;
        }
    }

    /// Removes the last `count`.
    pub(super) fn drop_last(&mut self, count: usize) {
        self.len = self.len.saturating_sub(count);
    }

    /// Shortens the last by `length` at its end.
    pub(super) fn shorten_last(&mut self, length: S) {
        if self.len > 0
            && let Some(Some(last)) = self.segments.get_mut((self.head + self.len - 1) % N)
        {
            last.length -= length;
            last.free = S::ZERO;
        }
    }

    /// The number of segments, the first included, that are passed without a stop.
    pub(super) fn run(&self) -> usize {
        match self.iter().skip(1).position(|planned| planned.from_rest) {
            Some(further) => further + 1,
            None => self.len,
        }
    }
}
