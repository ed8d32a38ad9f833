//! A zero-phase low-pass filter: a Butterworth filter of fourth order, run forwards and backwards.

use core::f64::consts::PI;

/// One section of second order: b (1 + 2 z⁻¹ + z⁻²) / (1 + a1 z⁻¹ + a2 z⁻²).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Section {
    b: f64,
    a1: f64,
    a2: f64,
}

/// The filter of a cut-off frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LowPass {
    sections: [Section; 2],
    /// Samples that the filter needs to settle.
    settling: usize,
}

impl LowPass {
    /// For a cut-off, below a quarter of the rate, and a sampling rate [Hz].
    pub(super) fn new(cutoff: f64, rate: f64) -> Self {
        let w = (PI * cutoff / rate).tan();
        // The poles' quality factors: 1/(2 cos(π/8)), 1/(2 cos(3π/8)).
        let section = |angle: f64| {
            let per_q = 2.0 * angle.cos();
            let a0 = 1.0 + w * per_q + w * w;
            Section {
                b: w * w / a0,
                a1: 2.0 * (w * w - 1.0) / a0,
                a2: (1.0 - w * per_q + w * w) / a0,
            }
        };
        Self {
            sections: [section(PI / 8.0), section(3.0 * PI / 8.0)],
            settling: (4.0 * rate / cutoff) as usize,
        }
    }

    pub(super) fn settling(&self) -> usize {
        self.settling
    }

    /// The filtered samples. Before the first and behind the last, they are continued by their
    /// mirror image about that sample.
    pub(super) fn apply(&self, samples: &[f64]) -> Vec<f64> {
        let (Some(&first), Some(&last)) = (samples.first(), samples.last()) else {
            return Vec::new();
        };
        let edge = self.settling.min(samples.len() - 1);
        let before = samples[1..=edge].iter().rev().map(|x| 2.0 * first - x);
        let count = samples.len();
        let behind = samples[count - 1 - edge..count - 1]
            .iter()
            .rev()
            .map(|x| 2.0 * last - x);
        let mut all: Vec<f64> = before
            .chain(samples.iter().copied())
            .chain(behind)
            .collect();
        for _ in 0..2 {
            for section in self.sections {
                section.run(&mut all);
            }
            all.reverse();
        }
        all[edge..edge + count].to_vec()
    }
}

impl Section {
    /// Filters in place, starting at rest at the first sample.
    fn run(self, samples: &mut [f64]) {
        let Some(&first) = samples.first() else {
            return;
        };
        let Self { b, a1, a2 } = self;
        let (mut x1, mut x2, mut y1, mut y2) = (first, first, first, first);
        for sample in samples {
            let x = *sample;
            let y = b * (x + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
            (x2, x1, y2, y1) = (x1, x, y1, y);
            *sample = y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::LowPass;
    use core::f64::consts::TAU;

    #[test]
    fn passes_slow_parts_without_delay_and_halves_the_cutoff() {
        let filter = LowPass::new(60.0, 10_000.0);
        let wave = |frequency: f64| -> Vec<f64> {
            (0..20_000)
                .map(|k| (TAU * frequency * f64::from(k) * 1e-4 + 0.3).sin())
                .collect()
        };
        for (frequency, gain) in [(4.0, 1.0), (60.0, 0.5), (240.0, 0.0)] {
            let (before, after) = (wave(frequency), filter.apply(&wave(frequency)));
            for k in (3000..17_000).step_by(7) {
                assert!((after[k] - gain * before[k]).abs() < 2e-5, "{frequency} Hz");
            }
        }
        assert_eq!(filter.apply(&[3.0; 50]).len(), 50);
        assert!(
            filter
                .apply(&[3.0; 50])
                .iter()
                .all(|y| (y - 3.0).abs() < 1e-10)
        );
    }
}
