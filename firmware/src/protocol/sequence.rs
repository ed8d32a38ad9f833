//! Sequence numbers: which order comes next, which has been before.

use core::cmp::Ordering;
use serde::{Deserialize, Serialize};

/// The number of an order. Numbers count up and wrap; of two, the one less than half a
/// turn ahead is the later (serial number arithmetic, RFC 1982).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sequence(pub u16);

/// What a number says about its order, seen from the order last obeyed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// The very next one: obey it.
    Next,
    /// The same again: the reply was lost, repeat it.
    Again,
    /// An older one that took its time: ignore it.
    Past,
    /// One after the next: some were lost that the host believes obeyed.
    Ahead,
}

impl Sequence {
    /// The number after this one.
    #[must_use]
    pub fn next(self) -> Self {
        Self(self.0.wrapping_add(1))
    }

    /// The turn of an order numbered `self` after the one numbered `last` was obeyed.
    pub fn turn_after(self, last: Self) -> Turn {
        let ahead = self.0.wrapping_sub(last.0).cast_signed();
        match ahead.cmp(&1) {
            Ordering::Equal => Turn::Next,
            Ordering::Greater => Turn::Ahead,
            Ordering::Less if ahead == 0 => Turn::Again,
            Ordering::Less => Turn::Past,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Sequence, Turn};

    #[test]
    fn numbers_keep_their_order_across_the_wrap() {
        for last in [0, 1, 0x7fff, 0x8000, 0xfffe, 0xffff_u16] {
            let turn = |by: u16| Sequence(last.wrapping_add(by)).turn_after(Sequence(last));
            assert_eq!(turn(0), Turn::Again);
            assert_eq!(turn(1), Turn::Next);
            assert_eq!(turn(2), Turn::Ahead);
            assert_eq!(turn(0x7fff), Turn::Ahead);
            assert_eq!(turn(0x8000), Turn::Past);
            assert_eq!(turn(0xffff), Turn::Past);
        }
    }
}
