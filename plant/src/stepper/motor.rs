//! A hybrid stepper motor with two phases, and what follows from its data in closed form.
//!
//! τ = −K i_a sin Nθ + K i_b cos Nθ − τ_d sin 4Nθ, with i_a = I cos φ and i_b = I sin φ:
//! τ = K I sin(φ − Nθ) − τ_d sin 4Nθ.
//!
//! θ is the motor's angle, φ that of the field, N a quarter of the full steps of a turn, K the holding torque over
//! the rated current I, τ_d the detent torque.

use serde::Deserialize;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt;

/// Speeds at which the line below the pull-out torque is compared with it.
const SPEEDS: u32 = 64;

/// What a driver gives the windings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DriverMode {
    /// The currents of the micro-steps: a chopper holds them, as SpreadCycle does.
    #[default]
    Current,
    /// A voltage along the micro-steps, as StealthChop does: the currents follow from it.
    Voltage,
}

/// As robot files have it.
impl fmt::Display for DriverMode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Current => "current",
            Self::Voltage => "voltage",
        })
    }
}

/// A stepper motor with its driver's micro-steps and its gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepper {
    /// Full steps in a turn of the motor.
    pub steps_per_turn: u32,
    /// Micro-steps in a full step.
    pub microsteps: u32,
    /// Motor turns per joint turn; negative if the motor turns against its joint.
    pub gear_ratio: f64,
    /// Rotor inertia at the motor's shaft [kg·m²].
    pub rotor_inertia: f64,
    /// Holding torque at the rated current, at the motor's shaft [N·m].
    pub holding_torque: f64,
    /// Rated current I of a phase [A].
    pub rated_current: f64,
    /// Resistance R of a phase [Ω].
    pub resistance: f64,
    /// Inductance L of a phase [H].
    pub inductance: f64,
    /// Detent torque τ_d at the motor's shaft [N·m].
    pub detent_torque: f64,
    /// Whether an encoder counts, as the settings' axis says; without one the counts are the micro-steps made.
    pub encoder: bool,
    /// What its driver gives the windings.
    pub driver: DriverMode,
}

impl Stepper {
    /// N, the periods of the torque in a turn of the motor.
    pub fn periods(&self) -> f64 {
        f64::from(self.steps_per_turn) / 4.0
    }

    /// K [N·m/A], equal to the back-EMF constant [V·s/rad].
    pub fn torque_constant(&self) -> f64 {
        self.holding_torque / self.rated_current
    }

    /// The stiffness of the field as a spring at the joint, k = G² N T at the rated current [N·m/rad].
    pub fn stiffness(&self) -> f64 {
        self.gear_ratio * self.gear_ratio * self.periods() * self.holding_torque
    }

    /// The field's angle φ after so many micro-steps [rad].
    pub fn field(&self, microsteps: i64) -> f64 {
        let per_full_step = i64::from(self.microsteps);
        // Whole turns of the field first: the angle stays exact however far the motor turns.
        let in_turn = microsteps.rem_euclid(4 * per_full_step);
        in_turn as f64 * FRAC_PI_2 / per_full_step as f64
    }

    /// The amplitude of the voltage of a driver in [`DriverMode::Voltage`] whose micro-steps turn the motor at this speed
    /// [rad/s]:
    ///
    /// U = √((R I)² + (N ω L I + K ω)²).
    ///
    /// It is the amplitude to which such a driver regulates itself in a motor without load, so that the current's vector
    /// has the length I: without load it lies along the rotor, where the back-EMF is across it (the equations of the
    /// [windings](super::Windings) in the rotor's frame, at rest). The field is then ahead of the rotor by
    /// atan((N L I + K) ω/(R I)).
    pub fn regulated_voltage(&self, speed: f64) -> f64 {
        let resistive = self.resistance * self.rated_current;
        let inductive = self.periods() * self.inductance * self.rated_current;
        libm::hypot(resistive, (inductive + self.torque_constant()) * speed)
    }

    /// The energy in the detents at that angle; 0 at a full step [J].
    pub fn detent_energy(&self, angle: f64) -> f64 {
        let phase = 4.0 * self.periods() * angle;
        self.detent_torque / (4.0 * self.periods()) * (1.0 - libm::cos(phase))
    }

    /// The greatest steady torque at the motor's speed ω [rad/s] on this supply [V], at the motor's shaft [N·m]:
    ///
    /// min(T, K V/|Z| − K² ω R/|Z|²), |Z|² = R² + (NωL)².
    ///
    /// V is the amplitude of the voltage that the driver gives a winding, T the holding torque. A driver that gives the
    /// full supply in turns gives up to 4/π of V and more torque. Where both terms of the minimum are near each other,
    /// current and voltage are limited at once, and there the motor gives up to 5 % less.
    /// A motor that brakes gives as much or more: there back-EMF and supply drive the current together.
    pub fn pull_out_torque(&self, speed: f64, supply: f64) -> f64 {
        self.driven_torque(speed, supply)
            .clamp(0.0, self.holding_torque)
    }

    /// The second term of the pull-out torque.
    fn driven_torque(&self, speed: f64, supply: f64) -> f64 {
        let (k, r, speed) = (self.torque_constant(), self.resistance, speed.abs());
        let reactance = self.periods() * speed * self.inductance;
        let squared = r * r + reactance * reactance;
        k * supply / squared.sqrt() - k * k * speed * r / squared
    }

    /// The speed up to which the currents follow the field on this supply [V], at the motor's shaft [rad/s]:
    ///
    /// ω = (4/π) V/(K + N L I).
    ///
    /// There the back-EMF and the inductance's voltage, which add up in a rotor without load, take the greatest fundamental
    /// that a driver makes of its supply. Above it the currents lag, and the rotor with them.
    pub fn tracked_speed(&self, supply: f64) -> f64 {
        let inductive = self.periods() * self.inductance * self.rated_current;
        4.0 / PI * supply / (self.torque_constant() + inductive)
    }

    /// A straight line below the pull-out torque at all speeds up to `fastest` [rad/s], as its torque at rest [N·m] and
    /// the slope by which it falls [N·m·s/rad]; the holding torque limits it besides. It is the tangent that, with this
    /// limit, leaves the greatest share of the pull-out torque where it leaves least.
    pub fn pull_out_line(&self, fastest: f64, supply: f64) -> [f64; 2] {
        let speeds = (1..=SPEEDS).map(|k| fastest.abs() * f64::from(k) / f64::from(SPEEDS));
        let curve: Vec<[f64; 2]> = speeds
            .map(|speed| [speed, self.driven_torque(speed, supply)])
            .collect();
        let tangents = curve.windows(2).map(|ends| {
            let slope = ((ends[0][1] - ends[1][1]) / (ends[1][0] - ends[0][0])).max(0.0);
            let rests = curve.iter().map(|[speed, torque]| torque + slope * speed);
            [rests.fold(f64::INFINITY, f64::min), slope]
        });
        let least_share = |[rest, slope]: [f64; 2]| {
            let limited = |torque: f64| torque.min(self.holding_torque);
            let shares = curve
                .iter()
                .map(|&[speed, torque]| limited(rest - slope * speed) / limited(torque));
            shares.fold(f64::INFINITY, f64::min)
        };
        tangents
            .max_by(|one, other| least_share(*one).total_cmp(&least_share(*other)))
            .unwrap_or([self.holding_torque, 0.0])
    }

    /// The frequency of small oscillations about the field at the rated current, √(N T/J)/2π [Hz], with the inertia
    /// of rotor and load at the motor's shaft [kg·m²].
    pub fn natural_frequency(&self, inertia: f64) -> f64 {
        (self.periods() * self.holding_torque / inertia).sqrt() / TAU
    }

    /// The fastest oscillation of its rotor, one that turns nothing else, at a full step, √(N (T + 4 τ_d)/J) [rad/s].
    pub(super) fn fastest_swing(&self) -> f64 {
        let torque = self.holding_torque + 4.0 * self.detent_torque;
        (self.periods() * torque / self.rotor_inertia).sqrt()
    }

    /// The inertia at the motor's shaft [kg·m²] that oscillates with this frequency [Hz].
    pub fn inertia_at(&self, natural_frequency: f64) -> f64 {
        self.periods() * self.holding_torque / (TAU * natural_frequency).powi(2)
    }
}
