//! A switch whose contacts bounce, or whose wire picks up a disturbance.

/// The level of a switch, filtered: it changes when [`Debounce::SAMPLES`] samples in a row agree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Debounce {
    level: bool,
    /// Samples in a row that differ from the level.
    different: u8,
}

impl Debounce {
    /// Samples in a row that change the level. At 10 kHz this delays it by 0.4 ms.
    pub const SAMPLES: u8 = 5;

    /// Takes a sample; returns the filtered level.
    #[inline]
    pub fn filter(&mut self, sample: bool) -> bool {
        if sample == self.level {
            self.different = 0;
        } else {
            self.different += 1;
            if self.different >= Self::SAMPLES {
                self.level = sample;
                self.different = 0;
            }
        }
        self.level
    }
}

#[cfg(test)]
mod tests {
    use super::Debounce;

    #[test]
    fn only_samples_in_a_row_change_the_level() {
        let mut switch = Debounce::default();
        for _ in 0..10 {
            for _ in 1..Debounce::SAMPLES {
                assert!(!switch.filter(true));
            }
            assert!(!switch.filter(false));
        }
        for _ in 1..Debounce::SAMPLES {
            assert!(!switch.filter(true));
        }
        assert!(switch.filter(true));
        assert!(switch.filter(false));
        assert!(switch.filter(true));
    }
}
