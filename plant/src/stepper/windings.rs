//! The two windings of a stepper motor, and the driver that controls their currents.
//!
//! L di/dt = v − R i − e, e_a = −K ω sin Nθ, e_b = K ω cos Nθ.
//!
//! The driver is the mean of an ideal chopper: in each integration step it gives the voltage within ± supply that
//! brings the current to its set-point by the end of the step. The ripple of a real one, some percent of the current at
//! 20 kHz or more, moves no rotor. The current rises as fast as supply and inductance let it, so the torque falls off
//! with the speed as it does in a real motor.

use super::motor::Stepper;
use crate::drives::Energy;

/// The windings' currents.
///
/// They are those in the middle of a step of the mechanics, which uses them; their own step goes from the middle of one
/// to the middle of the next. Energies are then exact to the second order in the step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Windings {
    /// i_a and i_b [A].
    pub phases: [f64; 2],
}

impl Windings {
    /// The motor's torque at its angle [rad] from a full step, the detents' included [N·m].
    pub fn torque(&self, motor: &Stepper, angle: f64) -> f64 {
        let (sin, cos) = libm::sincos(motor.periods() * angle);
        let [a, b] = self.phases;
        motor.torque_constant() * (b * cos - a * sin) + motor.detent(angle)
    }

    /// Advances by `time` [s] under this set-point of both currents [A], with the motor's angle [rad] and speed [rad/s]
    /// in the middle of that time, on a driver with this supply [V]. Returns the energies of the supply and of the
    /// resistance.
    pub fn step(
        &mut self,
        motor: &Stepper,
        set_point: [f64; 2],
        (angle, speed): (f64, f64),
        supply: f64,
        time: f64,
    ) -> Energy {
        let (sin, cos) = libm::sincos(motor.periods() * angle);
        let back = motor.torque_constant() * speed;
        let back_emf = [-back * sin, back * cos];
        let (r, l) = (motor.resistance, motor.inductance);
        let mut energy = Energy::default();
        for ((i, wanted), e) in self.phases.iter_mut().zip(set_point).zip(back_emf) {
            let v = l * (wanted - *i) / time + 0.5 * r * (wanted + *i) + e;
            let v = v.clamp(-supply, supply);
            // The trapezoidal rule: L Δi = (v − R (i + i')/2 − e) Δt.
            let half = 0.5 * r * time / l;
            let next = (*i * (1.0 - half) + (v - e) * time / l) / (1.0 + half);
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
