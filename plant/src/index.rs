//! The index output of an encoder: high for one count in each turn of its disc.

/// The index of one encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Index {
    /// Counts from the disc's zero in one of the pulses.
    at: i64,
    /// Counts from one pulse to the next.
    turn: i64,
}

impl Index {
    /// An index with a pulse in these counts, and one in each `turn` of counts.
    pub(crate) fn new(at: i32, turn: u32) -> Self {
        Self {
            at: at.into(),
            turn: i64::from(turn).max(1),
        }
    }

    /// Whether the output is high, so many counts from the disc's zero.
    pub(crate) fn is_shown(&self, counts: i32) -> bool {
        (i64::from(counts) - self.at) % self.turn == 0
    }
}

#[cfg(test)]
mod tests {
    use super::Index;

    #[test]
    fn one_count_in_each_turn_is_a_pulse_in_either_direction() {
        let index = Index::new(-1200, 500);
        for counts in -2000..2000 {
            let pulse = [-1700, -1200, -700, -200, 300, 800, 1300, 1800].contains(&counts);
            assert_eq!(index.is_shown(counts), pulse, "{counts}");
        }
    }
}
