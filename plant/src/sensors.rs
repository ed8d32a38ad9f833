//! The sensors: encoder counts, ADC codes and switches.

use fivebar_design::Noise;
use std::f64::consts::TAU;

/// The sensors of one driven joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSensors {
    /// Encoder counts per joint turn.
    pub counts_per_turn: f64,
    /// Joint angle at which homing finds the joint: at the home switch, the hard stop or the index
    /// pulse [rad].
    pub home: f64,
    /// What the encoder shows of the joint's angle at home [rad].
    pub shown_at_home: f64,
    /// Joint angle at which the home switch closes [rad].
    pub switch: f64,
    /// Whether the joint's angle increases towards its switch; beyond, the switch stays
    /// pressed.
    pub home_forward: bool,
    /// Motor current per ADC code [A].
    pub current_per_code: f64,
    /// ADC code at zero current.
    pub current_zero_code: f64,
    /// Error of the code at zero current [codes].
    pub current_offset: f64,
    /// Standard deviation of the current samples [codes].
    pub current_noise: f64,
}

/// Full scale of the 12-bit converters.
const ADC_FULL_SCALE: f64 = 4095.0;

/// The nearest code within the converter's range.
pub(crate) fn adc_code(value: f64) -> u16 {
    value.round().clamp(0.0, ADC_FULL_SCALE) as u16
}

impl JointSensors {
    /// Encoder counts at an angle that the encoder shows [rad], wrapping like the hardware's; `origin` are those at
    /// home. Home lies in the middle of its count: its angle is that of a calibrated arm, for which the encoder is
    /// right in the mean over its counts. Elsewhere in the count it would turn a drawing by up to half a count.
    #[inline]
    pub(crate) fn counts(&self, shown: f64, origin: i32) -> i32 {
        let turns = ((shown - self.shown_at_home) / TAU * self.counts_per_turn + 0.5).floor();
        // Keep the low 32 bits, as the counter does.
        origin.wrapping_add(turns as i64 as i32)
    }

    /// The counts at home of an absolute encoder, which counts from 0 there, so many turns of the joint on.
    pub(crate) fn absolute_origin(&self, turns: i32) -> i32 {
        -(f64::from(turns) * self.counts_per_turn).round() as i32
    }

    /// ADC code of a current [A].
    #[inline]
    pub(crate) fn current_code(&self, current: f64, noise: &mut Noise) -> u16 {
        let exact = current / self.current_per_code + self.current_zero_code;
        adc_code(exact + self.current_offset + self.current_noise * noise.normal())
    }

    /// Whether the home switch is pressed at a joint angle [rad].
    #[inline]
    pub(crate) fn at_home(&self, angle: f64) -> bool {
        if self.home_forward {
            angle >= self.switch
        } else {
            angle <= self.switch
        }
    }
}
