//! One driven joint: a brushed motor behind a gear, and friction.
//!
//! L di/dt = u − R i − k n ω. The torque at the joint is n k i − b ω − c s(ω/ω₀), with the
//! smooth sign s(x) = x/√(1 + x²). The rotor's inertia, n² J at the joint, is included in
//! the link's.

/// A motor, its gear and the friction at its joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Motor turns per joint turn, n.
    pub gear_ratio: f64,
    /// Rotor inertia J at the motor shaft [kg·m²].
    pub rotor_inertia: f64,
    /// Torque constant k [N·m/A], equal to the back-EMF constant [V·s/rad].
    pub torque_constant: f64,
    /// Winding resistance R [Ω].
    pub resistance: f64,
    /// Winding inductance L [H].
    pub inductance: f64,
    /// Viscous friction b at the joint [N·m·s/rad].
    pub viscous_friction: f64,
    /// Coulomb friction c at the joint [N·m].
    pub coulomb_friction: f64,
}

/// Joint speed ω₀ at which Coulomb friction changes its sign smoothly [rad/s]: far below
/// working speeds, yet wide enough for an integration step.
const SIGN_WIDTH: f64 = 0.02;

impl Motor {
    /// The rotor's inertia at the joint, n² J [kg·m²].
    #[inline]
    pub fn reflected_inertia(&self) -> f64 {
        self.rotor_inertia * self.gear_ratio * self.gear_ratio
    }

    /// Torque at the joint from the current [N·m], without friction.
    #[inline]
    pub fn torque(&self, current: f64) -> f64 {
        self.gear_ratio * self.torque_constant * current
    }

    /// Friction torque at the joint [N·m] at its speed `omega` [rad/s].
    #[inline(always)]
    pub fn friction(&self, omega: f64) -> f64 {
        let x = omega / SIGN_WIDTH;
        -self.viscous_friction * omega - self.coulomb_friction * x / (1.0 + x * x).sqrt()
    }

    /// di/dt [A/s] under `voltage` [V] at the terminals, with `current` [A] and the joint's
    /// speed `omega` [rad/s].
    #[inline]
    pub fn current_rate(&self, voltage: f64, current: f64, omega: f64) -> f64 {
        let back_emf = self.gear_ratio * self.torque_constant * omega;
        (voltage - self.resistance * current - back_emf) / self.inductance
    }

    /// The fastest decay rate of the winding's current and of friction on a link of `inertia`
    /// [kg·m²] [1/s]. An integration step must not be much longer than its inverse.
    pub(crate) fn fastest_rate(&self, inertia: f64) -> f64 {
        let friction = self.viscous_friction + self.coulomb_friction / SIGN_WIDTH;
        (self.resistance / self.inductance).max(friction / inertia)
    }

    /// Shorts half of the turns. The others drive; in the shorted ones the speed ω drives the current
    /// (n k/2) ω/(R/2) [A], which brakes like viscous friction of n² k²/(2 R).
    pub(crate) fn short_half(&mut self) {
        let constant = self.gear_ratio * self.torque_constant;
        self.viscous_friction += constant * constant / (2.0 * self.resistance);
        self.torque_constant *= 0.5;
        self.resistance *= 0.5;
        self.inductance *= 0.25;
    }
}
