//! What each tick with power checks by the motor's equation: whether its current sensor shows the current that
//! flows, and whether its encoder counts while the motor turns.
//!
//! An encoder whose counts stop looks like a joint that stands. The position loop then pushes harder and
//! harder, because the reference goes on. So a joint that stands while its error grows is suspect: either
//! something holds it, or it turns unseen. A motor that turns has a back-EMF, which the equation shows: less
//! current than a motor that stands would have at this voltage. A motor that is held has none; then the
//! following error ends it.
//!
//! Both faults make voltage and current contradict each other. It is the encoder if its counts stand, the
//! error has grown and the current follows its set-point, else the current sensor. A broken lead of a
//! motor, or a bridge that does not apply its duty, gives the fault of the current sensor, too: no
//! measured value tells them apart in time.

use crate::safety::Fault;
use crate::settings::{AxisSettings, Settings};
use core::f32::consts::TAU;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::control::{MotorEquation, MotorEstimate};

/// Counts within which a joint stands.
const STILL: u32 = 2;
/// Ticks after which a joint whose counts are within them stands.
const STANDS: u32 = 5;
/// Ticks in a row for which it must look like an encoder that has stopped: impacts in worn joints make
/// shorter ones.
const LASTS: u32 = 10;
/// Growth of the error of a joint that stands, as a share of the greatest following error.
const GROWN: f32 = 0.02;
/// Least growth of this error [counts].
const GROWN_COUNTS: f32 = 8.0;
/// Difference of a current that follows its set-point: as a share of it, and of the continuous current.
const FOLLOWS: [f32; 2] = [0.25, 0.1];

/// Ticks after a release in which duties of before it may still act.
const RELEASED: u8 = 2;

/// The constants of one joint's check.
#[derive(Clone)]
pub(super) struct MotorLimits {
    equation: MotorEquation<f32>,
    /// Growth of the error of a joint that stands [rad].
    grown: f32,
    /// Least difference of a current that follows its set-point [A].
    follows: f32,
}

/// What a joint's tick knows of its motor.
#[derive(Clone, Copy)]
pub(super) struct MotorSample {
    pub(super) counts: i32,
    /// ω̂ [rad/s].
    pub(super) velocity: f32,
    /// The position error of the tick before [rad].
    pub(super) error: f32,
    /// [A].
    pub(super) current: f32,
    /// The set-point of the current in the tick before [A].
    pub(super) demand: f32,
    /// The duty of the tick before.
    pub(super) duty: f32,
    /// [V].
    pub(super) bus_voltage: f32,
}

/// The check of one joint's motor.
#[derive(Clone)]
pub(super) struct MotorCheck {
    estimate: MotorEstimate<f32>,
    /// The duty that acted until this tick.
    acting: f32,
    /// Where the joint stands, or was when it last moved [counts].
    place: i32,
    /// Its error there [rad].
    error: f32,
    /// Ticks for which it has been there.
    ticks: u32,
    /// Ticks for which it has looked like an encoder that has stopped.
    suspect: u32,
    /// Ticks in which the acting duty and the current are not known yet.
    unknown: u8,
}

impl MotorLimits {
    pub(super) fn new(axis: &AxisSettings, settings: &Settings) -> Self {
        let count = TAU / (axis.encoder_counts as f32 * Scalar::abs(axis.gear_ratio));
        let grown = GROWN * settings.protection.following_error;
        let [_, follows] = FOLLOWS;
        Self {
            equation: MotorEquation::new(
                axis.resistance,
                axis.inductance,
                axis.gear_ratio * axis.torque_constant,
                axis.continuous_current,
                1.0 / settings.control.tick_rate,
            ),
            grown: grown.max(GROWN_COUNTS * count),
            follows: follows * axis.continuous_current,
        }
    }
}

impl MotorCheck {
    pub(super) fn new() -> Self {
        Self {
            estimate: MotorEstimate::of(0.0),
            acting: 0.0,
            place: 0,
            error: 0.0,
            ticks: 0,
            suspect: 0,
            unknown: RELEASED,
        }
    }

    /// The loops are cleared. The bridge may have been on until now, with a current. What else is kept is
    /// taken anew in the ticks after it.
    pub(super) fn release(&mut self) {
        self.estimate.current = 0.0;
        self.unknown = RELEASED;
    }

    /// The least current that flows by the motor's equation [A].
    #[inline(always)]
    pub(super) fn least_current(&self) -> f32 {
        self.estimate.least_current()
    }

    /// One tick: the fault that the motor's equation shows.
    #[inline(always)]
    pub(super) fn fault(&mut self, limits: &MotorLimits, sample: &MotorSample) -> Option<Fault> {
        let equation = &limits.equation;
        let current = sample.current;
        if self.unknown > 0 {
            *self = Self {
                estimate: MotorEstimate::of(current),
                acting: sample.duty,
                place: sample.counts,
                error: sample.error,
                ticks: 0,
                suspect: 0,
                unknown: self.unknown - 1,
            };
            return None;
        }
        let turned = sample.counts.wrapping_sub(self.place);
        if turned.unsigned_abs() > STILL {
            self.place = sample.counts;
            self.error = sample.error;
            self.ticks = 0;
        }
        self.ticks = self.ticks.saturating_add(1);
        let stands = self.ticks > STANDS;
        // The observer forgets its speed only slowly.
        let velocity = if stands { 0.0 } else { sample.velocity };
        let voltage = self.acting * sample.bus_voltage;
        // The duty of the tick before acts from this one to the next.
        self.acting = sample.duty;
        let contradicts = equation.contradicts(&mut self.estimate, voltage, velocity, current);
        if stands && Scalar::abs(sample.error - self.error) > limits.grown {
            let [share, _] = FOLLOWS;
            let behind = Scalar::abs(sample.demand - current);
            let follows = behind <= share * Scalar::abs(current) + limits.follows;
            if follows && equation.turns(&self.estimate, current) {
                self.suspect += 1;
                if self.suspect >= LASTS {
                    return Some(Fault::EncoderStuck);
                }
                // What contradicts the equation is the encoder that may have stopped.
                return None;
            }
        }
        self.suspect = 0;
        contradicts.then_some(Fault::CurrentSensor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_flows_in_the_two_ticks_after_a_release_is_not_judged() {
        let settings = Settings::BENCHTOP;
        let [axis, _] = &settings.axes;
        let limits = MotorLimits::new(axis, &settings);
        // More than a tick's contradiction: 15 times the continuous current.
        let sample = MotorSample {
            counts: 0,
            velocity: 0.0,
            error: 0.0,
            current: 20.0 * axis.continuous_current,
            demand: 0.0,
            duty: 0.0,
            bus_voltage: 24.0,
        };
        let mut check = MotorCheck::new();
        let faults = [(); 2].map(|()| check.fault(&limits, &sample));
        assert_eq!(faults, [None; 2]);
        // From then on it is, from the current that flowed.
        let shorted = MotorSample {
            current: -sample.current,
            ..sample
        };
        let fault = check.fault(&limits, &shorted);
        assert_eq!(fault, Some(Fault::CurrentSensor));
        check.release();
        assert_eq!(check.fault(&limits, &sample), None);
    }

    /// A joint that stands while its error has grown, at 2 A where its voltage would drive 3 A: the fault
    /// within 50 ticks, at a current this much behind its set-point [A].
    fn standing(behind: f32) -> Option<Fault> {
        let settings = Settings::BENCHTOP;
        let [axis, _] = &settings.axes;
        let limits = MotorLimits::new(axis, &settings);
        let mut check = MotorCheck::new();
        let mut sample = MotorSample {
            counts: 5,
            velocity: 0.0,
            error: 0.0,
            current: 2.0,
            demand: 2.0 + behind,
            duty: 3.0 * axis.resistance / 24.0,
            bus_voltage: 24.0,
        };
        for _ in 0..10 {
            assert_eq!(check.fault(&limits, &sample), None);
        }
        sample.error = 2.0 * limits.grown;
        (0..50).find_map(|_| check.fault(&limits, &sample))
    }

    #[test]
    fn an_encoder_has_stopped_only_if_the_current_follows_its_set_point() {
        // A quarter of 2 A, and 0.13 A.
        for (behind, fault) in [
            (0.55, Some(Fault::EncoderStuck)),
            (-0.55, Some(Fault::EncoderStuck)),
            (0.75, None),
            (-0.75, None),
        ] {
            assert_eq!(standing(behind), fault, "{behind} A");
        }
    }
}
