//! Defects of sensors and of their wires: what reaches the controller of a sample.

use crate::sensors::adc_code;
use fivebar_design::Noise;
use fivebar_firmware::SensorSample;
use fivebar_kinematics::five_bar::Joint;
use std::collections::VecDeque;

/// The defects of all sensors.
#[derive(Clone, Debug, Default)]
pub(crate) struct SensorDefects {
    pub(crate) encoders: [Option<EncoderDefect>; 2],
    pub(crate) currents: [Option<CurrentDefect>; 2],
    /// The levels of index outputs that are stuck.
    pub(crate) indices: [Option<bool>; 2],
    pub(crate) bus: Option<BusDefect>,
    /// Whether the wire of a fault output is shorted to ground.
    pub(crate) driver_fault: [bool; 2],
}

/// A defect of an encoder.
#[derive(Clone, Debug)]
pub(crate) enum EncoderDefect {
    /// It counts this many times as much since it had these counts.
    Gain(i32, f64),
    /// Its counts are late.
    Late(Late<i32>),
    /// One channel has been stuck since these counts.
    ChannelStuck(i32),
    /// Its counts are wrong by up to so many.
    Noise(i32),
}

/// A defect of a current sensor.
#[derive(Clone, Debug)]
pub(crate) enum CurrentDefect {
    /// It shows this many times the current; the first value is its code at no current.
    Gain(f64, f64),
    /// It shows this code.
    Stuck(u16),
    /// Its codes are late.
    Late(Late<u16>),
}

/// A defect of the bus voltage's sensor.
#[derive(Clone, Copy, Debug)]
pub(crate) enum BusDefect {
    /// It shows this code.
    Stuck(u16),
    /// It shows this many times the voltage.
    Gain(f64),
}

/// Values that arrive a number of ticks late.
#[derive(Clone, Debug)]
pub(crate) struct Late<T> {
    past: VecDeque<T>,
}

impl<T: Copy> Late<T> {
    /// Until the first late value arrives, the last one in time is shown: `present`.
    pub(crate) fn new(present: T, ticks: u32) -> Self {
        Self {
            past: (0..ticks).map(|_| present).collect(),
        }
    }

    fn shown(&mut self, value: T) -> T {
        self.past.push_back(value);
        self.past.pop_front().unwrap_or(value)
    }
}

impl EncoderDefect {
    fn shown(&mut self, counts: i32, noise: &mut Noise) -> i32 {
        match self {
            Self::Gain(from, gain) => {
                let turned = f64::from(counts.wrapping_sub(*from));
                from.wrapping_add((*gain * turned).floor() as i64 as i32)
            }
            Self::Late(late) => late.shown(counts),
            // The level of the other channel changes with every second count.
            Self::ChannelStuck(from) => from.wrapping_add((counts.wrapping_sub(*from) >> 1) & 1),
            Self::Noise(most) => {
                let error = noise
                    .integer()
                    .rem_euclid(most.saturating_mul(2).saturating_add(1));
                counts.wrapping_add(error - *most)
            }
        }
    }
}

impl CurrentDefect {
    fn shown(&mut self, code: u16) -> u16 {
        match self {
            Self::Gain(zero, gain) => adc_code(*zero + *gain * (f64::from(code) - *zero)),
            Self::Stuck(stuck) => *stuck,
            Self::Late(late) => late.shown(code),
        }
    }
}

impl SensorDefects {
    /// What the controller gets of a sample.
    pub(crate) fn seen(&mut self, sample: SensorSample, noise: &mut Noise) -> SensorSample {
        let mut seen = sample;
        for j in Joint::ALL {
            if let Some(defect) = &mut self.encoders[j] {
                seen.counts[j] = defect.shown(sample.counts[j], noise);
            }
            if let Some(defect) = &mut self.currents[j] {
                seen.drives.current[j] = defect.shown(sample.drives.current[j]);
            }
            seen.index[j] = self.indices[j].unwrap_or(sample.index[j]);
            seen.driver_fault[j] |= self.driver_fault[j];
        }
        seen.drives.bus_voltage = match self.bus {
            None => sample.drives.bus_voltage,
            Some(BusDefect::Stuck(code)) => code,
            Some(BusDefect::Gain(gain)) => adc_code(gain * f64::from(sample.drives.bus_voltage)),
        };
        seen
    }
}

#[cfg(test)]
mod tests {
    use super::{BusDefect, CurrentDefect, EncoderDefect, Late, SensorDefects};
    use fivebar_design::Noise;
    use fivebar_firmware::SensorSample;
    use fivebar_firmware::drives::BrushedSample;

    /// The counts of joint 1 that are shown while the encoder turns from 100 on.
    fn shown<const N: usize>(mut defect: EncoderDefect, counts: [i32; N]) -> [i32; N] {
        counts.map(|counts| defect.shown(counts, &mut Noise::new(1)))
    }

    #[test]
    fn an_encoder_counts_backwards_half_late_or_up_and_down() {
        let backwards = shown(EncoderDefect::Gain(100, -1.0), [100, 103, 98]);
        assert_eq!(backwards, [100, 97, 102]);
        let half = shown(EncoderDefect::Gain(100, 0.5), [102, 110]);
        assert_eq!(half, [101, 105]);
        let late = shown(EncoderDefect::Late(Late::new(100, 2)), [101, 102, 103, 104]);
        assert_eq!(late, [100, 100, 101, 102]);
        let stuck = shown(
            EncoderDefect::ChannelStuck(100),
            [100, 101, 102, 103, 104, 99],
        );
        assert_eq!(stuck, [100, 100, 101, 101, 100, 101]);
    }

    #[test]
    fn a_current_sensor_shows_half_of_its_current_or_shows_it_reversed() {
        let shown = |gain, code| CurrentDefect::Gain(2048.0, gain).shown(code);
        assert_eq!([shown(0.5, 2148), shown(-1.0, 2148)], [2098, 1948]);
        assert_eq!([shown(0.0, 2148), shown(1e9, 2148)], [2048, 4095]);
    }

    #[test]
    fn noise_keeps_within_its_counts_and_reaches_them() {
        let mut noise = Noise::new(1);
        let mut defect = EncoderDefect::Noise(2);
        let errors: Vec<_> = (0..200)
            .map(|_| defect.shown(50, &mut noise) - 50)
            .collect();
        assert_eq!(errors.iter().min(), Some(&-2));
        assert_eq!(errors.iter().max(), Some(&2));
    }

    #[test]
    fn only_the_defective_sensors_differ_from_the_sample() {
        let sample = SensorSample {
            counts: [7, 8],
            drives: BrushedSample {
                current: [2000, 2100],
                bus_voltage: 2000,
            },
            ..SensorSample::default()
        };
        let noise = &mut Noise::new(1);
        let mut sound = SensorDefects::default();
        assert_eq!(sound.seen(sample, noise), sample);
        let mut defects = SensorDefects {
            currents: [None, Some(CurrentDefect::Stuck(2048))],
            indices: [Some(true), None],
            bus: Some(BusDefect::Gain(0.5)),
            driver_fault: [false, true],
            ..SensorDefects::default()
        };
        let seen = SensorSample {
            drives: BrushedSample {
                current: [2000, 2048],
                bus_voltage: 1000,
            },
            index: [true, false],
            driver_fault: [false, true],
            ..sample
        };
        assert_eq!(defects.seen(sample, noise), seen);
    }
}
