//! By how much the field of a motor must be ahead of its rotor at a speed that its supply cannot follow.
//!
//! The driver asks for currents along the field, and the supply is too low for them: the currents are smaller and later.
//! How much so is found by the windings: a rotor turns at a constant speed, its field is ahead of it by an angle, and the
//! mean of the torque is taken over a period. The angle at which it is none is searched for.
//!
//! The angle of a load adds to it. Both together are the field's angle of a loaded motor within 0.08 rad of the field, a
//! twentieth of a full step.

use super::motor::{DriverMode, Stepper};
use super::windings::{Rotor, Windings};
use fivebar_firmware::settings::FieldLag;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Steps of the windings in a period of the field.
const STEPS: u32 = 200;
/// Periods until the currents repeat themselves: e^-4 of the start is left with R = 0.08 N ω L, and its torque has no mean.
const PERIODS: u32 = 8;
/// Halvings of the angles between which it is searched: to 5e-4 rad.
const HALVINGS: u32 = 12;
/// The speed from which on a rotor lags, over the speed that the supply follows. From π/4 of it on the peak of the voltage
/// is cut, which has no effect at first.
const ONSET: f64 = 0.85;
/// The speeds at which the parabola is the lag, likewise.
const FITTED: [f64; 2] = [1.15, 1.5];

/// The greatest number that settings take.
const GREATEST: f64 = 1e6;

impl Stepper {
    /// The motor's speed up to which the lag of its rotor is known on this supply [V], at the motor's shaft [rad/s]. Of a
    /// driver that gives a voltage it is not known.
    pub fn led_speed(&self, supply: f64) -> f64 {
        let [.., fastest] = FITTED;
        match self.driver {
            DriverMode::Current => fastest * self.tracked_speed(supply),
            DriverMode::Voltage => self.tracked_speed(supply),
        }
    }

    /// The lag of its rotor without load on this supply [V], at the joint's speed, as a parabola through the lag at two
    /// speeds. None for a driver that gives a voltage, and for a motor whose numbers do not give one.
    pub fn field_lag(&self, supply: f64) -> FieldLag {
        if self.driver == DriverMode::Voltage {
            return FieldLag::NONE;
        }
        let tracked = self.tracked_speed(supply);
        // (d/e) of d = e (s − b e), at both.
        let [near, far] = FITTED.map(|share| {
            let excess = (share - ONSET) * tracked;
            (excess, self.free_angle(share * tracked, supply) / excess)
        });
        let bend = (near.1 - far.1) / (far.0 - near.0);
        let slope = near.1 + bend * near.0;
        let ratio = self.gear_ratio.abs();
        let at_joint = [ONSET * tracked / ratio, slope * ratio, bend * ratio * ratio];
        // 0 for what is not a number.
        let bounded = |number: f64| {
            if number > 0.0 {
                number.min(GREATEST)
            } else {
                0.0
            }
        };
        let [from, slope, bend] = at_joint.map(|number| bounded(number) as f32);
        FieldLag { from, slope, bend }
    }

    /// The angle of the field before a rotor without load at this speed [rad/s] on this supply [V] [rad of the field].
    fn free_angle(&self, speed: f64, supply: f64) -> f64 {
        let [mut low, mut high] = [-0.1, FRAC_PI_2];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.mean_torque(middle, speed, supply) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// The mean torque of a rotor at this speed [rad/s] with the field ahead of it by this angle [rad], without detents
    /// [N·m].
    fn mean_torque(&self, angle: f64, speed: f64, supply: f64) -> f64 {
        let without_detents = Self {
            detent_torque: 0.0,
            ..*self
        };
        let time = TAU / (self.periods() * speed * f64::from(STEPS));
        let mut windings = Windings::default();
        let mut sum = 0.0;
        for step in 1..=PERIODS * STEPS {
            // The currents are those of the middle of a step: a step goes from there to the middle of the next.
            let turned = f64::from(step) * time * speed;
            let middle = turned + 0.5 * time * speed;
            let (sin, cos) = libm::sincos(self.periods() * middle + angle);
            let set_point = [cos, sin].map(|share| share * self.rated_current);
            let rotor = Rotor::new(self, turned, speed);
            windings.step(self, set_point, &rotor, supply, time);
            if step > (PERIODS - 1) * STEPS {
                sum += windings.torque(&without_detents, &Rotor::new(self, middle, speed));
            }
        }
        sum / f64::from(STEPS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NEMA17: Stepper = Stepper {
        steps_per_turn: 200,
        microsteps: 16,
        gear_ratio: 4.0,
        rotor_inertia: 5.4e-6,
        holding_torque: 0.40,
        rated_current: 1.7,
        resistance: 1.5,
        inductance: 2.8e-3,
        detent_torque: 0.015,
        encoder: false,
        driver: DriverMode::Current,
    };

    /// The mean angle of the field before a rotor that turns freely under this load [N·m], pulled by its field from rest
    /// to this speed [rad/s] [rad of the field]. A torque against the difference of both speeds, of no mean, ends its swing.
    fn pulled(motor: &Stepper, speed: f64, load: f64, supply: f64) -> f64 {
        const TIME: f64 = 5e-6;
        const INERTIA: f64 = 6e-5;
        let (mut angle, mut omega, mut field, mut field_speed) = (0.0, 0.0, 0.0_f64, 0.0_f64);
        let mut windings = Windings::default();
        let (mut sum, mut count) = (0.0, 0);
        for step in 0..200_000 {
            let before = field_speed;
            field_speed = (field_speed + 400.0 * TIME).min(speed);
            let reached = load * field_speed / speed;
            field += field_speed * TIME;
            let rotor = Rotor::new(motor, angle, omega);
            let (sin, cos) = libm::sincos(motor.periods() * field);
            let set_point = [cos, sin].map(|share| share * motor.rated_current);
            let torque = windings.torque(motor, &rotor);
            windings.step(motor, set_point, &rotor, supply, TIME);
            let pull = INERTIA * (field_speed - before) / TIME;
            let damping = 0.01 * (field_speed - omega);
            omega += (torque - reached + pull + damping) / INERTIA * TIME;
            angle += omega * TIME;
            if step >= 150_000 {
                sum += motor.periods() * (field - angle);
                count += 1;
            }
        }
        sum / f64::from(count)
    }

    #[test]
    fn a_rotor_that_its_field_pulls_lags_by_the_parabola_and_the_angle_of_its_load() {
        let slow = Stepper {
            resistance: 4.0,
            inductance: 8e-3,
            rated_current: 0.9,
            gear_ratio: -3.0,
            ..NEMA17
        };
        for (motor, supply) in [(NEMA17, 24.0), (NEMA17, 12.0), (slow, 24.0)] {
            let lag = motor.field_lag(supply);
            let tracked = motor.tracked_speed(supply);
            for share in [0.7, 0.9, 1.0, 1.25, 1.45] {
                let speed = share * tracked;
                let at_joint = (speed / motor.gear_ratio.abs()) as f32;
                let free = f64::from(lag.at(at_joint));
                assert_eq!(free > 0.0, share > ONSET);
                for load in [-0.3, 0.0, 0.3] {
                    let led = free + libm::asin(load);
                    let found = pulled(&motor, speed, load * motor.holding_torque, supply);
                    assert!((found - led).abs() < 0.08, "{found} for {led} rad");
                }
            }
        }
        let voltage = Stepper {
            driver: DriverMode::Voltage,
            ..NEMA17
        };
        assert_eq!(voltage.field_lag(24.0), FieldLag::NONE);
    }
}
