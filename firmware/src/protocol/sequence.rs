//! Sequence numbers: whether a command is the next one, a repeat, an old one or too new.

use core::cmp::Ordering;
use serde::{Deserialize, Serialize};

/// The number of a command. Numbers count up and wrap; of two numbers, the one that is ahead
/// by less than half the range is the later one (serial number arithmetic, RFC 1982).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sequence(pub u16);

/// How a command's number compares with that of the last command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SequenceCheck {
    /// The next command: execute it.
    Next,
    /// The last command again, because its reply was lost: send the reply again.
    Repeat,
    /// An old command that arrives late: ignore it.
    Old,
    /// Some commands before it are missing: refuse it.
    Gap,
}

impl Sequence {
    /// The number after this one.
    #[must_use]
    pub fn next(self) -> Self {
        Self(self.0.wrapping_add(1))
    }

    /// Compares the number of a command with that of the last one executed or refused.
    pub fn check_after(self, last: Self) -> SequenceCheck {
        let ahead = self.0.wrapping_sub(last.0).cast_signed();
        match ahead.cmp(&1) {
            Ordering::Equal => SequenceCheck::Next,
            Ordering::Greater => SequenceCheck::Gap,
            Ordering::Less if ahead == 0 => SequenceCheck::Repeat,
            Ordering::Less => SequenceCheck::Old,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Sequence, SequenceCheck};

    #[test]
    fn numbers_keep_their_order_across_the_wrap() {
        for last in [0, 1, 0x7fff, 0x8000, 0xfffe, 0xffff_u16] {
            let check = |by: u16| Sequence(last.wrapping_add(by)).check_after(Sequence(last));
            assert_eq!(check(0), SequenceCheck::Repeat);
            assert_eq!(check(1), SequenceCheck::Next);
            assert_eq!(check(2), SequenceCheck::Gap);
            assert_eq!(check(0x7fff), SequenceCheck::Gap);
            assert_eq!(check(0x8000), SequenceCheck::Old);
            assert_eq!(check(0xffff), SequenceCheck::Old);
        }
    }
}
