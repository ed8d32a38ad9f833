//! The index output of an encoder: high for one count in each turn of its disc.

/// The index of one encoder, which is shown at home.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Index {
    /// Counts from one pulse to the next.
    turn: i64,
}

impl Index {
    /// An index with one pulse in each `turn` of counts.
    pub(crate) fn new(turn: u32) -> Self {
        Self {
            turn: i64::from(turn).max(1),
        }
    }

    /// Whether the output is high, so many counts from home.
    pub(crate) fn is_shown(&self, counts: i32) -> bool {
        i64::from(counts) % self.turn == 0
    }
}

#[cfg(test)]
mod tests {
    use super::Index;

    #[test]
    fn one_count_in_each_turn_is_a_pulse_in_either_direction() {
        let index = Index::new(500);
        for counts in -1200..1200 {
            let pulse = [-1000, -500, 0, 500, 1000].contains(&counts);
            assert_eq!(index.is_shown(counts), pulse, "{counts}");
        }
    }
}
