//! When a sample of telemetry is due, and its number.

/// Counts the samples that are due.
#[derive(Clone)]
pub(super) struct Sampler {
    /// Ticks from one sample to the next; 0 for none.
    every: u16,
    /// Tick of the sample due last.
    tick: u32,
    /// Samples due so far.
    due: u32,
}

impl Sampler {
    /// No samples.
    pub(super) const fn off() -> Self {
        Self {
            every: 0,
            tick: 0,
            due: 0,
        }
    }

    /// Starts counting at this tick.
    pub(super) fn begin(&mut self, every: u16, tick: u32) {
        *self = Self {
            every,
            tick,
            due: 0,
        };
    }

    /// Goes on counting after the ticks were reset to 0.
    pub(super) fn restart_ticks(&mut self) {
        self.tick = 0;
    }

    /// The number of the sample due at this tick, if one is. Samples that were due since
    /// the last call are skipped, which shows as a gap in the numbers.
    pub(super) fn due(&mut self, tick: u32) -> Option<u32> {
        let every = u32::from(self.every);
        let samples = tick.wrapping_sub(self.tick).checked_div(every)?;
        if samples == 0 {
            return None;
        }
        self.tick = self.tick.wrapping_add(samples.wrapping_mul(every));
        self.due = self.due.wrapping_add(samples);
        Some(self.due.wrapping_sub(1))
    }
}

#[cfg(test)]
mod tests {
    use super::Sampler;

    #[test]
    fn samples_are_numbered_as_they_fall_due_and_missed_ones_leave_a_gap() {
        let mut sampler = Sampler::off();
        assert_eq!(sampler.due(1000), None);
        sampler.begin(10, u32::MAX - 4);
        assert_eq!(sampler.due(u32::MAX), None);
        assert_eq!(sampler.due(5), Some(0));
        assert_eq!(sampler.due(14), None);
        assert_eq!(sampler.due(15), Some(1));
        assert_eq!(sampler.due(47), Some(4));
        assert_eq!(sampler.due(54), None);
        assert_eq!(sampler.due(55), Some(5));
        sampler.restart_ticks();
        assert_eq!(sampler.due(10), Some(6));
        sampler.begin(0, 55);
        assert_eq!(sampler.due(1000), None);
    }
}
