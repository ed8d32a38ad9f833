//! The gear or belt between a motor and its joint: two inertias and a spring.
//!
//! x = θm − θ, with the rotor's angle over the gear ratio, θm;
//! τ = k x + d ẋ;
//! n² J θ̈m = τm − τ, and the joint is turned by τ.
//!
//! The rotor held and the joint free, or the reverse, it oscillates at √(k/J) with the damping
//! ratio d/(2 √(k J)); both free, at √(k (1/J₁ + 1/J₂)) (Groß, Hamann, Wiegärtner, Electrical
//! Feed Drives, 2001). With backlash the spring's deflection is x outside the gap
//! ([`crate::backlash`]).

use crate::backlash::Backlash;
use crate::motor::Motor;
use std::f64::consts::TAU;

/// The gear or belt of one drive. Angles and torques are at the joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transmission {
    /// Stiffness k [N·m/rad]; none: rigid.
    pub stiffness: Option<f64>,
    /// Damping d beside the stiffness [N·m·s/rad].
    pub damping: f64,
}

/// The spring between a rotor and its joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spring {
    /// k [N·m/rad].
    stiffness: f64,
    /// d [N·m·s/rad].
    damping: f64,
    backlash: Option<Backlash>,
}

/// Natural frequency of a rotor on the flanks of a gear that is otherwise rigid [rad/s]: 2 kHz, stiff,
/// yet slow enough for a few integration steps in each tick.
const FLANK_RESONANCE: f64 = TAU * 2e3;
/// Damping ratio of that oscillation [1]: metal on metal damps little.
const FLANK_DAMPING: f64 = 0.05;

impl Spring {
    /// The spring of a transmission with this full gap [rad]. None if it is rigid, has no gap and
    /// turns evenly.
    pub(crate) fn new(
        transmission: &Transmission,
        gap: f64,
        is_uneven: bool,
        motor: &Motor,
    ) -> Option<Self> {
        let backlash = (gap > 0.0).then(|| Backlash::new(gap));
        let inertia = motor.reflected_inertia();
        let (stiffness, damping) = match transmission.stiffness {
            Some(stiffness) => (stiffness, transmission.damping),
            None => {
                if backlash.is_none() && !is_uneven {
                    return None;
                }
                let damping = 2.0 * FLANK_DAMPING * inertia * FLANK_RESONANCE;
                let given = transmission.damping;
                (
                    inertia * FLANK_RESONANCE * FLANK_RESONANCE,
                    if given > 0.0 { given } else { damping },
                )
            }
        };
        Some(Self {
            stiffness,
            damping,
            backlash,
        })
    }

    /// Transmits nothing from now on.
    pub(crate) fn break_apart(&mut self) {
        (self.stiffness, self.damping) = (0.0, 0.0);
    }

    /// The deflection of the spring [rad] at x [rad].
    fn deflection(&self, x: f64) -> f64 {
        self.backlash.map_or(x, |backlash| backlash.outside(x))
    }

    /// τ [N·m] at x [rad] and ẋ [rad/s].
    #[inline]
    pub(crate) fn torque(&self, x: f64, rate: f64) -> f64 {
        match &self.backlash {
            None => self.stiffness * x + self.damping * rate,
            Some(backlash) => backlash.torque(x, rate, self.stiffness, self.damping),
        }
    }

    /// Energy in the spring at x [J].
    pub(crate) fn energy(&self, x: f64) -> f64 {
        0.5 * self.stiffness * self.deflection(x).powi(2)
    }

    /// Power that the damping takes [W] while the spring transmits `torque`.
    #[inline]
    pub(crate) fn loss(&self, x: f64, rate: f64, torque: f64) -> f64 {
        (torque - self.stiffness * self.deflection(x)) * rate
    }

    /// Natural frequency between a rotor and a joint of these inertias [rad/s].
    pub(crate) fn resonance(&self, inertia: [f64; 2]) -> f64 {
        (self.stiffness * (1.0 / inertia[0] + 1.0 / inertia[1])).sqrt()
    }

    /// Decay rate of their relative motion by the damping [1/s].
    pub(crate) fn damping_rate(&self, inertia: [f64; 2]) -> f64 {
        self.damping * (1.0 / inertia[0] + 1.0 / inertia[1])
    }
}
