//! Samples that are not those of the arm.

use crate::bytes::Bytes;
use fivebar_firmware::SensorSample;
use fivebar_firmware::drives::BrushedSample;

/// How the samples differ from those of the arm.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Hostile {
    /// All values at random, anew in each tick.
    Noise(u32),
    /// This sample, again and again.
    Stuck(SensorSample),
    /// One value of the arm's sample replaced.
    Replaced(u8, u16),
    /// Counts that run away by this much in each tick.
    Drift([i8; 2]),
}

impl Hostile {
    pub(crate) fn from_bytes(bytes: &mut Bytes<'_>) -> Self {
        match bytes.byte() % 4 {
            0 => Self::Noise(bytes.word()),
            1 => Self::Stuck(sample(&mut || bytes.word())),
            2 => Self::Replaced(bytes.byte(), bytes.short()),
            _ => Self::Drift([bytes.byte().cast_signed(), bytes.byte().cast_signed()]),
        }
    }

    /// The sample in place of the arm's, in the n-th tick of the disturbance.
    pub(crate) fn apply(self, mut real: SensorSample, n: u32) -> SensorSample {
        match self {
            Self::Noise(seed) => {
                let mut state = seed ^ n.wrapping_mul(0x9e37_79b9);
                sample(&mut || {
                    state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
                    state ^ (state >> 15)
                })
            }
            Self::Stuck(sample) => sample,
            Self::Replaced(which, value) => {
                let joint = usize::from(which & 1);
                match which >> 1 & 7 {
                    0 => real.counts[joint] = i32::from(value),
                    1 => real.drives.current[joint] = value,
                    2 => real.drives.bus_voltage = value,
                    3 => real.home[joint] ^= true,
                    4 => real.emergency_stop = true,
                    5 => real.driver_fault[joint] = true,
                    6 => real.missed_ticks = u32::from(value % 6),
                    _ => real.counts[joint] = real.counts[joint].wrapping_neg(),
                }
                real
            }
            Self::Drift(by) => {
                for (counts, by) in real.counts.iter_mut().zip(by) {
                    *counts = counts.wrapping_add(i32::from(by).wrapping_mul(n.cast_signed()));
                }
                real
            }
        }
    }
}

fn sample(word: &mut impl FnMut() -> u32) -> SensorSample {
    let flags = word();
    SensorSample {
        counts: [word().cast_signed(), word().cast_signed()],
        drives: BrushedSample {
            current: [word() as u16, word() as u16],
            bus_voltage: word() as u16 % 4096,
        },
        home: [flags & 1 != 0, flags & 2 != 0],
        index: [flags & 0x8000 != 0, flags & 0x1_0000 != 0],
        emergency_stop: flags & 0x1c == 0,
        driver_fault: [flags & 0xe0 == 0, flags & 0x700 == 0],
        missed_ticks: if flags & 0x7800 == 0 { word() } else { 0 },
    }
}
