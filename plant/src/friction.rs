//! Friction that holds a joint at rest: presliding, breakaway and the Stribeck effect.
//!
//! e(ω) = exp(−(ω/ωs)²)
//! g(ω) = c (1 + s e)
//! ż = ω − α σ₀ |ω| z / g
//! τ = −(σ₀ z + σ₁ e ż + b ω)
//!
//! z is the deflection of the bristles, c the Coulomb friction, c (1 + s) the breakaway torque with
//! the stiction s, b the viscous friction. This is the LuGre model (Canudas de Wit, Olsson, Åström,
//! Lischinsky, A new model for control of systems with friction, IEEE TAC 40, 1995) with σ₁ falling
//! off with the speed, so that the model stays passive (Olsson 1996), and with α, by which it holds
//! without drift below breakaway (Dupont, Hayward, Armstrong, Altpeter, Single state elastoplastic
//! friction models, IEEE TAC 47, 2002):
//!
//! α = 0 while ω and z have unlike signs or |z| < z₀ = 0.7 c/σ₀, 1 from |z| = g/σ₀ on, and
//! 3 u² − 2 u³ with u = (|z| − z₀)/(g/σ₀ − z₀) between them (there a half sine).

use crate::motor::Motor;

/// Friction with presliding, of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Presliding {
    /// c [N·m].
    coulomb: f64,
    /// s.
    stiction: f64,
    /// b [N·m·s/rad].
    viscous: f64,
    /// σ₀ [N·m/rad].
    stiffness: f64,
    /// σ₁ [N·m·s/rad].
    damping: f64,
}

/// Deflection at breakaway [rad]. Direct drives and geared motors break away after 0.1 to 3 mrad
/// at the joint (Kelly, Llamas, Campa, IEEE TIM 49, 2000: 1 mrad).
pub(crate) const BREAKAWAY: f64 = 5e-4;
/// Speed ωs at which the stiction has fallen to 1/e [rad/s]: 10 to 100 mrad/s there.
pub(crate) const STRIBECK: f64 = 0.05;
/// Damping ratio of the joint's inertia on its bristles.
const BRISTLE_DAMPING: f64 = 0.3;
/// (ω/ωs)² from which e is less than the rounding error of 1 + s e.
const NEGLIGIBLE: f64 = 40.0;
/// z₀ in c/σ₀.
const ELASTIC: f64 = 0.7;

/// Rate and torque of the friction, and the power that it takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sliding {
    /// ż [rad/s].
    pub(crate) rate: f64,
    /// τ [N·m].
    pub(crate) torque: f64,
    /// Power lost [W].
    pub(crate) loss: f64,
}

impl Presliding {
    /// The friction of a motor's joint with stiction, on a link of `inertia` [kg·m²]. None without
    /// stiction or Coulomb friction.
    pub(crate) fn new(motor: &Motor, stiction: f64, inertia: f64) -> Option<Self> {
        let coulomb = motor.coulomb_friction;
        let stiffness = coulomb * (1.0 + stiction) / BREAKAWAY;
        (stiction > 0.0 && coulomb > 0.0).then(|| Self {
            coulomb,
            stiction,
            viscous: motor.viscous_friction,
            stiffness,
            damping: 2.0 * BRISTLE_DAMPING * (stiffness * inertia).sqrt(),
        })
    }

    /// The friction at the joint's speed ω [rad/s] and the deflection z [rad].
    #[inline]
    pub(crate) fn at(&self, omega: f64, z: f64) -> Sliding {
        let squared = (omega / STRIBECK) * (omega / STRIBECK);
        let falling = if squared < NEGLIGIBLE {
            libm::exp(-squared)
        } else {
            0.0
        };
        let level = self.coulomb * (1.0 + self.stiction * falling);
        let plastic = self.plastic(omega, z, level) * self.stiffness * omega.abs() * z / level;
        let rate = omega - plastic;
        let damped = self.damping * falling * rate + self.viscous * omega;
        Sliding {
            rate,
            torque: -(self.stiffness * z + damped),
            // −τ ω less the change of the stored energy, σ₀ z ż.
            loss: self.stiffness * z * plastic + damped * omega,
        }
    }

    /// α at the steady torque g = `level` [N·m].
    #[inline]
    fn plastic(&self, omega: f64, z: f64, level: f64) -> f64 {
        if omega * z <= 0.0 {
            return 0.0;
        }
        let elastic = ELASTIC * self.coulomb / self.stiffness;
        let steady = level / self.stiffness;
        let u = ((z.abs() - elastic) / (steady - elastic)).clamp(0.0, 1.0);
        u * u * (3.0 - 2.0 * u)
    }

    /// Energy in the bristles [J].
    pub(crate) fn energy(&self, z: f64) -> f64 {
        0.5 * self.stiffness * z * z
    }

    /// The rate of the bristles where the joint slides at the speed ω [1/s].
    pub(crate) fn sliding_rate(&self, omega: f64) -> f64 {
        2.0 * self.stiffness * omega.abs() / self.coulomb
    }

    /// The rate of a joint of `inertia` on its bristles [1/s].
    pub(crate) fn presliding_rate(&self, inertia: f64) -> f64 {
        (self.stiffness / inertia).sqrt() + self.damping / inertia
    }
}

#[cfg(test)]
mod tests {
    use super::{BREAKAWAY, Presliding, STRIBECK};
    use crate::motor::Motor;

    fn friction() -> (Motor, Presliding) {
        let motor = Motor {
            gear_ratio: 8.0,
            rotor_inertia: 1e-6,
            torque_constant: 0.02,
            resistance: 2.0,
            inductance: 1e-3,
            viscous_friction: 1.5e-3,
            coulomb_friction: 9e-3,
        };
        (motor, Presliding::new(&motor, 0.5, 1.3e-3).unwrap())
    }

    /// At a constant speed the torque becomes c (1 + s e) + b ω against the motion, after the
    /// presliding distance and a few time constants g/(σ₀ ω) more.
    #[test]
    fn the_steady_torque_is_the_stribeck_curve() {
        let (motor, friction) = friction();
        for omega in [0.1, 0.5, 1.0, 2.0, 20.0, 400.0].map(|share| share * STRIBECK) {
            for omega in [omega, -omega] {
                let mut z = 0.0;
                let step = 1e-3 * BREAKAWAY / omega.abs();
                for _ in 0..20_000 {
                    z += friction.at(omega, z).rate * step;
                }
                let falling = (-(omega / STRIBECK).powi(2)).exp();
                let level = motor.coulomb_friction * (1.0 + 0.5 * falling);
                let expected = -level * omega.signum() - motor.viscous_friction * omega;
                let found = friction.at(omega, z);
                assert!(
                    (found.torque - expected).abs() < 1e-3 * expected.abs(),
                    "{omega}"
                );
                // All power is lost when nothing is stored any more.
                assert!((found.loss + found.torque * omega).abs() < 1e-3 * found.loss);
            }
        }
    }

    #[test]
    fn at_rest_it_is_a_spring_that_breaks_away_at_its_deflection() {
        let (motor, friction) = friction();
        let torque = friction.at(0.0, 0.3 * BREAKAWAY).torque;
        assert!((torque + 0.3 * 1.5 * motor.coulomb_friction).abs() < 1e-15);
        // Below 0.7 c the deflection follows the joint: nothing slides.
        let z = 0.69 / 1.5 * BREAKAWAY;
        assert_eq!(friction.at(1e-3, z).rate, 1e-3);
        assert!(friction.at(1e-9, BREAKAWAY).rate.abs() < 1e-15);
        // Backwards it unloads.
        assert_eq!(friction.at(-1e-3, BREAKAWAY).rate, -1e-3);
    }

    #[test]
    fn without_stiction_or_without_coulomb_friction_there_is_none() {
        let (motor, _) = friction();
        assert!(Presliding::new(&motor, 0.0, 1e-3).is_none());
        let smooth = Motor {
            coulomb_friction: 0.0,
            ..motor
        };
        assert!(Presliding::new(&smooth, 0.5, 1e-3).is_none());
    }
}
