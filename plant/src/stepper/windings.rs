//! The two windings of a stepper motor, and its driver.
//!
//! L di/dt = v − R i − e, e_a = −K ω sin Nθ, e_b = K ω cos Nθ.
//!
//! A driver in current mode is the mean of an ideal chopper: in each integration step it gives the voltage within ± supply that
//! brings the current to its set-point by the end of the step. The ripple of a real one, some percent of the current at
//! 20 kHz or more, moves no rotor. The current rises as fast as supply and inductance let it, so the torque falls off
//! with the speed as it does in a real motor.
//!
//! A driver in voltage mode gives a voltage and has no loop within an electrical period. The currents then lag by R and L
//! and by the back-EMF, and a rotor that swings drives currents that excite it: from some speed on its swing grows until it
//! slips, without any load (mid-band instability).

use super::motor::Stepper;
use crate::drives::Energy;

/// A rotor as its windings see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotor {
    /// cos Nθ.
    cos: f64,
    /// sin Nθ.
    sin: f64,
    /// ω [rad/s].
    speed: f64,
}

impl Rotor {
    /// A rotor at the motor's angle [rad] from a full step, with the motor's speed [rad/s].
    pub fn new(motor: &Stepper, angle: f64, speed: f64) -> Self {
        let (sin, cos) = libm::sincos(motor.periods() * angle);
        Self { cos, sin, speed }
    }

    /// The sum of both angles, which takes no sine, and of both speeds.
    #[inline]
    pub(crate) fn turned(&self, by: &Self) -> Self {
        Self {
            cos: self.cos * by.cos - self.sin * by.sin,
            sin: self.sin * by.cos + self.cos * by.sin,
            speed: self.speed + by.speed,
        }
    }
}

/// The windings' currents.
///
/// The currents are those in the middle of a step of the windings. The torque that acts during that step takes them;
/// their own step goes from the middle of one to the middle of the next. Energies are then exact to the second order in
/// the step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Windings {
    /// i_a and i_b [A].
    pub phases: [f64; 2],
}

impl Windings {
    /// The motor's torque with its rotor there, the detents' included [N·m].
    #[inline]
    pub fn torque(&self, motor: &Stepper, rotor: &Rotor) -> f64 {
        let Rotor { cos, sin, .. } = *rotor;
        let [a, b] = self.phases;
        // sin 4Nθ.
        let detents = 4.0 * sin * cos * (1.0 - 2.0 * sin * sin);
        motor.torque_constant() * (b * cos - a * sin) - motor.detent_torque * detents
    }

    /// Advances by `time` [s] under this set-point of both currents [A], with the rotor as it is in the middle of that
    /// time, on a driver with this supply [V]. Returns the energies of the supply and of the resistance.
    #[inline]
    pub fn step(
        &mut self,
        motor: &Stepper,
        set_point: [f64; 2],
        rotor: &Rotor,
        supply: f64,
        time: f64,
    ) -> Energy {
        let half_r = 0.5 * motor.resistance;
        let per_ampere = motor.inductance / time;
        self.advance(motor, rotor, time, |phase, i, e| {
            let wanted = set_point[phase];
            let v = per_ampere * (wanted - i) + half_r * (wanted + i) + e;
            v.clamp(-supply, supply)
        })
    }

    /// Advances by `time` [s] under these voltages [V], likewise.
    #[inline]
    pub fn step_under_voltage(
        &mut self,
        motor: &Stepper,
        voltage: [f64; 2],
        rotor: &Rotor,
        time: f64,
    ) -> Energy {
        self.advance(motor, rotor, time, |phase, _, _| voltage[phase])
    }

    /// Advances by `time` [s] under the voltage [V] that follows from the phase, its current [A] and its back-EMF [V].
    #[inline]
    fn advance(
        &mut self,
        motor: &Stepper,
        rotor: &Rotor,
        time: f64,
        voltage: impl Fn(usize, f64, f64) -> f64,
    ) -> Energy {
        let back = motor.torque_constant() * rotor.speed;
        let back_emf = [-back * rotor.sin, back * rotor.cos];
        let (r, l) = (motor.resistance, motor.inductance);
        let half = 0.5 * r * time / l;
        let (per_volt, per_drop) = (time / l, 1.0 / (1.0 + half));
        let mut energy = Energy::default();
        for (phase, (i, e)) in self.phases.iter_mut().zip(back_emf).enumerate() {
            let v = voltage(phase, *i, e);
            // The trapezoidal rule: L Δi = (v − R (i + i')/2 − e) Δt.
            let next = (*i * (1.0 - half) + (v - e) * per_volt) * per_drop;
            let mean = 0.5 * (*i + next);
            energy.supplied += v * mean * time;
            energy.lost += r * mean * mean * time;
            *i = next;
        }
        energy
    }

    /// The length of the vector of both currents [A].
    pub fn current(&self) -> f64 {
        let [a, b] = self.phases;
        libm::hypot(a, b)
    }

    /// Energy in the windings [J].
    pub fn energy(&self, motor: &Stepper) -> f64 {
        let [a, b] = self.phases;
        0.5 * motor.inductance * (a * a + b * b)
    }
}

#[cfg(test)]
mod tests {
    use super::{Rotor, Windings};
    use crate::stepper::{DriverMode, Stepper};
    use std::f64::consts::TAU;

    #[test]
    fn the_detents_torque_is_the_slope_of_their_energy_and_holds_full_steps() {
        let motor = Stepper {
            steps_per_turn: 200,
            microsteps: 16,
            gear_ratio: 4.0,
            rotor_inertia: 5.4e-6,
            holding_torque: 0.40,
            rated_current: 1.7,
            resistance: 1.5,
            inductance: 2.8e-3,
            detent_torque: 0.02,
            encoder: false,
            driver: DriverMode::Current,
        };
        let full_step = TAU / 200.0;
        let without_current = Windings::default();
        let detent = |angle| without_current.torque(&motor, &Rotor::new(&motor, angle, 0.0));
        for share in [0.0, 0.1, 0.25, 0.4, 0.7] {
            let angle = share * full_step;
            let small = 1e-6;
            let slope = motor.detent_energy(angle + small) - motor.detent_energy(angle - small);
            let torque = detent(angle);
            assert!((torque + slope / (2.0 * small)).abs() < 1e-7, "{share}");
        }
        assert!(detent(0.25 * full_step) < -0.0199);
        assert!(detent(3.25 * full_step) < -0.0199);
    }
}
