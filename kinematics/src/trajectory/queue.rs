//! The spans ahead, first in, first out.

use super::piece::Shape;
use super::ramp::Caps;
use crate::Scalar;

/// A shape and how it may be moved along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span<S> {
    pub(super) shape: Shape<S>,
    /// How far it goes: [m], for joints [rad], at rest [s].
    pub(super) length: S,
    /// How much of its end the next corner may take [m].
    pub(super) free: S,
    pub(super) caps: Caps<S>,
    pub(super) tag: u32,
    /// It must be entered from rest.
    pub(super) from_rest: bool,
}

/// A ring of spans.
#[derive(Clone, Copy, Debug)]
pub(super) struct Queue<S, const N: usize> {
    spans: [Option<Span<S>>; N],
    head: usize,
    len: usize,
}

impl<S: Scalar, const N: usize> Queue<S, N> {
    pub(super) fn new() -> Self {
        const {
            assert!(N >= 4, "a look-ahead of fewer than two moves is none");
        }
        Self {
            spans: [None; N],
            head: 0,
            len: 0,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// The span `index` places behind the first.
    pub(super) fn get(&self, index: usize) -> Option<&Span<S>> {
        if index < self.len {
            self.spans.get((self.head + index) % N)?.as_ref()
        } else {
            None
        }
    }

    pub(super) fn first(&self) -> Option<&Span<S>> {
        self.get(0)
    }

    pub(super) fn last(&self) -> Option<&Span<S>> {
        self.get(self.len.checked_sub(1)?)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Span<S>> {
        (0..self.len).filter_map(|index| self.get(index))
    }

    /// Append; the caller has made sure of the room.
    pub(super) fn push(&mut self, span: Span<S>) {
        if let Some(slot) = self.spans.get_mut((self.head + self.len) % N)
            && self.len < N
        {
            *slot = Some(span);
            self.len += 1;
        }
    }

    /// Drop the first.
    pub(super) fn pop(&mut self) {
        if self.len > 0 {
            self.head = (self.head + 1) % N;
            self.len -= 1;
        }
    }

    /// Drop the last `count`.
    pub(super) fn drop_last(&mut self, count: usize) {
        self.len = self.len.saturating_sub(count);
    }

    /// Take `length` off the end of the last.
    pub(super) fn shorten_last(&mut self, length: S) {
        if self.len > 0
            && let Some(Some(last)) = self.spans.get_mut((self.head + self.len - 1) % N)
        {
            last.length = last.length - length;
            last.free = S::ZERO;
        }
    }

    /// How many spans, the first included, are moved along without coming to rest.
    pub(super) fn run(&self) -> usize {
        match self.iter().skip(1).position(|span| span.from_rest) {
            Some(further) => further + 1,
            None => self.len,
        }
    }
}
