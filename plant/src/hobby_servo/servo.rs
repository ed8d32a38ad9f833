//! A hobby servo: its motor, and the position loop in its case.
//!
//! e = s (w − w₀) − φ; e₀ = e beyond the dead band; ω_d = e₀ ω₀/B within ±ω₀; τ = T (u − ω/ω₀).
//!
//! w is the width of the pulse, w₀ that at home, s the angle per width, φ and ω the shaft's angle from home and its
//! speed, ω₀ the greatest speed, T the stall torque. u is the motor's voltage over the supply's: ω/ω₀ + G (ω_d − ω)/ω₀
//! within ±1. Inside the dead band u is 0: the loop shorts the motor, which brakes it.
//!
//! No data sheet tells B and G. They are such that a servo without load neither swings nor overshoots: its speed follows
//! in 1/G of the motor's own time constant.

/// B, the error beyond the dead band at which a servo turns at its greatest speed [rad].
const BAND: f64 = 0.15;
/// G, how much stiffer the loop makes the speed than the motor is by itself.
const SPEED_GAIN: f64 = 20.0;

/// Below this voltage the electronics of a servo do not work, and above this one they break [V]: they are rated for 4.8 to
/// 8.4 V.
const WORKS: f64 = 3.5;
const BREAKS: f64 = 10.0;

/// What a supply makes of the electronics in a servo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Electronics {
    /// Too little voltage: no torque.
    Off,
    /// They work.
    Work,
    /// So much that they are broken from then on.
    Broken,
}

impl Electronics {
    /// On a supply of this voltage [V].
    pub(super) fn on(volts: f64) -> Self {
        if volts > BREAKS {
            Self::Broken
        } else if volts < WORKS {
            Self::Off
        } else {
            Self::Work
        }
    }
}

/// A hobby servo. Speed, torque and inertia are of its shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HobbyServo {
    /// Turns of its shaft per joint turn; negative if it turns against its joint.
    pub gear_ratio: f64,
    /// Inertia of its motor and gears at the shaft [kg·m²].
    pub rotor_inertia: f64,
    /// Two widths of the pulse [s].
    pub pulse_range: [f64; 2],
    /// The angle by which the shaft turns between them [rad].
    pub travel: f64,
    /// Width of the pulse at which the joint is at its home angle [s].
    pub home_width: f64,
    /// Change of the width up to which the servo does not react [s].
    pub dead_band: f64,
    /// Pulses in a second [Hz].
    pub frame_rate: f64,
    /// Greatest speed at the nominal supply [rad/s].
    pub max_speed: f64,
    /// Torque at rest at the nominal supply [N·m].
    pub stall_torque: f64,
}

impl HobbyServo {
    /// The resolution of the timer that makes the pulses [s].
    pub const UNIT: f64 = 0.5e-6;

    /// The shaft's angle per width of the pulse [rad/s].
    pub fn angle_per_width(&self) -> f64 {
        let [least, greatest] = self.pulse_range;
        self.travel / (greatest - least)
    }

    /// The dead band as an angle of the shaft [rad].
    pub fn dead_angle(&self) -> f64 {
        self.dead_band * self.angle_per_width()
    }

    /// Units of the timer in a turn of the shaft. A rounded number: over the travel it is wrong by half a unit at most.
    pub fn units_per_turn(&self) -> f64 {
        (std::f64::consts::TAU / (self.angle_per_width() * Self::UNIT)).round()
    }

    /// The longest time from a set-point to its torque: a frame and the longest pulse [s].
    pub fn longest_delay(&self) -> f64 {
        let [one, other] = self.pulse_range;
        1.0 / self.frame_rate + one.max(other)
    }

    /// The time by which the servo's own loop follows a moving set-point late, B/ω₀ [s].
    pub fn lag(&self) -> f64 {
        BAND / self.max_speed
    }

    /// The error beyond the dead band at which the servo gives its stall torque at rest [rad].
    pub fn stall_error(&self) -> f64 {
        BAND / SPEED_GAIN
    }

    /// The shaft's torque τ at this error e [rad] and this speed ω [rad/s], on a supply with this share of the nominal
    /// voltage [N·m].
    pub fn torque(&self, error: f64, speed: f64, supply: f64) -> f64 {
        let dead = self.dead_angle();
        let back_emf = speed / self.max_speed;
        let beyond = error - error.clamp(-dead, dead);
        let voltage = if beyond == 0.0 {
            0.0
        } else {
            let wanted = (beyond / BAND).clamp(-1.0, 1.0);
            back_emf + SPEED_GAIN * (wanted - back_emf)
        };
        self.stall_torque * (voltage.clamp(-1.0, 1.0) * supply - back_emf)
    }
}
