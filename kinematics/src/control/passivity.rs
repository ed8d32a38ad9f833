//! How stiff a spring a controller may render so that it gives a hand no energy.
//!
//! A spring K and a damper D between the tool and a point, made of sampled angles, act late. By Colgate and Schenkel
//! ("Passivity of a class of sampled-data systems", Journal of Robotic Systems 14, 1997) a sampled law H that holds its torque for
//! a period T is passive behind a friction b, whatever the hand is that is passive, if at each frequency up to that of Nyquist
//!
//! b ≥ T/(2 (1 − cos ωT)) Re[(1 − e^(−jωT)) H(e^(jωT))].
//!
//! Here H = (K A + D V) C: the observer's angle A and velocity V, and the current loop C = g/(z² − z + g). With R = ((z − 1)/(z − p))²,
//! A = 1 − p² R and V = (1 − p)²/T · z/(z − 1) · R. The right side is K a(ω) + D v(ω), and with the greatest a and v it is enough that
//!
//! diag(b1, b4) ⪰ Jᵀ (a K + v D) J.
//!
//! Of a law without lags and with the difference of two angles as velocity a is T/2 and v is 1, so K < 2 (b − |D|)/T. So 2 a is the
//! effective period, and v < 1, because the observer sees little of the highest frequencies.

use super::discrete::decay;
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Frequencies at which the condition is computed: so many up to that of Nyquist, denser where they are low.
const STEPS: u16 = 256;
/// The first of them: below it the condition does not change, and `f32` loses digits.
const LOWEST: u16 = 8;
/// What the peak between two of them may exceed both by.
const BETWEEN: f64 = 1.01;
/// The greatest gain g of the current loop, for torques that come at once.
const MOST_GAIN: f64 = 0.5;
/// A joint with less friction [N·m·s/rad] is taken for one with this.
const LEAST_FRICTION: f64 = 1e-9;

/// A symmetric matrix of the plane: a stiffness [N/m] or a damping [N·s/m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symmetric<S> {
    /// Along x.
    pub xx: S,
    /// Between x and y.
    pub xy: S,
    /// Along y.
    pub yy: S,
}

impl<S: Scalar> Symmetric<S> {
    /// The same in all directions.
    pub fn isotropic(value: S) -> Self {
        Self {
            xx: value,
            xy: S::ZERO,
            yy: value,
        }
    }

    /// M v.
    #[inline(always)]
    pub fn apply(&self, v: Vector2<S>) -> Vector2<S> {
        Vector2::new(self.xx * v.x + self.xy * v.y, self.xy * v.x + self.yy * v.y)
    }

    /// a M + b N.
    #[must_use]
    pub fn combined(&self, a: S, other: &Self, b: S) -> Self {
        Self {
            xx: a * self.xx + b * other.xx,
            xy: a * self.xy + b * other.xy,
            yy: a * self.yy + b * other.yy,
        }
    }

    /// The least and the greatest eigenvalue.
    #[inline(always)]
    pub fn eigenvalues(&self) -> [S; 2] {
        let (mean, half) = (S::HALF * (self.xx + self.yy), S::HALF * (self.xx - self.yy));
        let radius = (half * half + self.xy * self.xy).sqrt();
        [mean - radius, mean + radius]
    }

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        (self.xx + self.xy + self.yy).is_finite()
    }
}

/// The friction in the joints of an arm, before which a spring is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointDamping<S> {
    /// 1/b1, 1/b4 [rad/(N·m·s)].
    per_friction: [S; 2],
}

impl<S: Scalar> JointDamping<S> {
    /// Viscous friction of each joint [N·m·s/rad] that is not compensated.
    pub fn new(friction: [S; 2]) -> Self {
        let least = S::from_f64(LEAST_FRICTION);
        Self {
            per_friction: friction.map(|b| S::ONE / if b > least { b } else { least }),
        }
    }

    /// By how much a demanded damping [N·s/m] exceeds what the friction gives with these columns of the tool's Jacobian [m]:
    /// the greatest eigenvalue of b^(−½) Jᵀ M J b^(−½). Up to 1 it suffices.
    #[inline(always)]
    pub fn load(&self, demand: &Symmetric<S>, [by1, by4]: [Vector2<S>; 2]) -> S {
        let (turned1, turned4) = (demand.apply(by1), demand.apply(by4));
        let [per1, per4] = self.per_friction;
        let (xx, yy, xy) = (
            per1 * by1.dot(&turned1),
            per4 * by4.dot(&turned4),
            by1.dot(&turned4),
        );
        let (mean, half) = (S::HALF * (xx + yy), S::HALF * (xx - yy));
        mean + (half * half + per1 * per4 * xy * xy).sqrt()
    }

    /// J b⁻¹ Jᵀ [m/(N·s)]: how fast the tool yields to a force.
    fn mobility(&self, [by1, by4]: [Vector2<S>; 2]) -> Symmetric<S> {
        let [per1, per4] = self.per_friction;
        let of = |a: Vector2<S>, per: S| Symmetric {
            xx: a.x * a.x * per,
            xy: a.x * a.y * per,
            yy: a.y * a.y * per,
        };
        of(by1, per1).combined(S::ONE, &of(by4, per4), S::ONE)
    }
}

/// How late a sampled loop renders a spring and a damper.
///
/// ```
/// use fivebar_kinematics::control::{RenderingLag, JointDamping, Symmetric};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// // 10 kHz, an observer of 3,120 rad/s, currents with a lag of 1/3,500 s.
/// let lag = RenderingLag::new(1e-4, 3120.0, 1.0 / 3500.0, 0.0);
/// // 0.1 m from one joint each, with a friction of 1.5e-3 N·m·s/rad.
/// let jacobian = [Vector2::new(0.1, 0.0), Vector2::new(0.0, 0.1)];
/// let joints = JointDamping::new([1.5e-3; 2]);
/// let [least, greatest] = lag.greatest_stiffness(&joints, jacobian);
/// assert!(300.0 < least && least < 400.0_f64 && (greatest - least).abs() < 1e-6); // N/m
/// let demand = lag.demand(&Symmetric::isotropic(least), &Symmetric::isotropic(0.0));
/// assert!((joints.load(&demand, jacobian) - 1.0).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderingLag<S> {
    /// The greatest a [s]: half of the effective period.
    stiffness: S,
    /// The greatest v.
    damping: S,
}

impl<S: Scalar> RenderingLag<S> {
    /// Of a loop with this period [s], bandwidth of its observer [rad/s], lag of its torques [s], the tick of delay included, and
    /// latency of its encoders [s].
    pub fn new(period: S, observer_bandwidth: S, torque_lag: S, latency: S) -> Self {
        let pole = decay(observer_bandwidth * period);
        let gain = Self::gain(period, torque_lag);
        let (mut stiffness, mut damping) = (S::ZERO, S::ZERO);
        for k in LOWEST..=STEPS {
            let share = f64::from(k) / f64::from(STEPS);
            // ωT.
            let turn = S::from_f64(core::f64::consts::PI * share * share);
            let [a, v] = factors(turn, period, pole, gain, latency);
            if a > stiffness {
                stiffness = a;
            }
            if v > damping {
                damping = v;
            }
        }
        let between = S::from_f64(BETWEEN);
        Self {
            stiffness: between * stiffness,
            damping: between * damping,
        }
    }

    /// g of a current loop with this lag [s] in ticks of this period [s].
    pub fn gain(period: S, torque_lag: S) -> S {
        let (gain, most) = (period / torque_lag, S::from_f64(MOST_GAIN));
        if gain < most { gain } else { most }
    }

    /// The greater lags of two loops.
    #[must_use]
    pub fn worse(&self, other: &Self) -> Self {
        let greater = |a: S, b: S| if a > b { a } else { b };
        Self {
            stiffness: greater(self.stiffness, other.stiffness),
            damping: greater(self.damping, other.damping),
        }
    }

    /// a K + v D: the damping [N·s/m] that a spring [N/m] and a damper [N·s/m] demand of the arm.
    pub fn demand(&self, stiffness: &Symmetric<S>, damping: &Symmetric<S>) -> Symmetric<S> {
        stiffness.combined(self.stiffness, damping, self.damping)
    }

    /// The greatest stiffness [N/m] along one direction that is passive with these columns of the tool's Jacobian [m]: the least
    /// and the greatest one of all directions. The least one is passive in all directions at once.
    pub fn greatest_stiffness(
        &self,
        joints: &JointDamping<S>,
        jacobian: [Vector2<S>; 2],
    ) -> [S; 2] {
        let [least, most] = joints.mobility(jacobian).eigenvalues();
        [most, least].map(|mobility| S::ONE / (self.stiffness * mobility))
    }
}

/// a(ω) [s] and v(ω), ωT being `turn`: −Im[e^(−jωT/2) A C] T/(2 sin ωT/2), which is the theorem's right side without the
/// difference of two near numbers.
fn factors<S: Scalar>(turn: S, period: S, pole: S, gain: S, latency: S) -> [S; 2] {
    let (one, z) = (Vector2::new(S::ONE, S::ZERO), Vector2::unit(turn));
    let (gone, off) = (z - one, z - Vector2::new(pole, S::ZERO));
    let ratio = quotient(gone, off);
    let r = ratio.to_base_frame(ratio);
    let angle = one - r * (pole * pole);
    let share = S::ONE - pole;
    let velocity = quotient(z.to_base_frame(r), gone) * (share * share / period);
    let current = quotient(
        Vector2::new(gain, S::ZERO),
        z.to_base_frame(gone) + Vector2::new(gain, S::ZERO),
    );
    let late = Vector2::unit(-(S::HALF * turn + turn * latency / period));
    let (sine, _) = (S::HALF * turn).sin_cos();
    let scale = -period / (S::TWO * sine);
    [angle, velocity].map(|of| {
        let response = of.to_base_frame(current).to_base_frame(late);
        response.y * scale
    })
}

/// a/b of two complex numbers.
fn quotient<S: Scalar>(a: Vector2<S>, b: Vector2<S>) -> Vector2<S> {
    let conjugate = Vector2::new(b.x, -b.y);
    a.to_base_frame(conjugate) * (S::ONE / b.length_squared())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::{ObserverState, VelocityObserver};
    use proptest::prelude::*;

    /// Re of ∫ torque · velocity of a rendered spring and damper on a joint that is moved by cos ωt, over the velocity's square, by
    /// simulation: what the law gives to the joint [N·m·s/rad].
    fn given(omega: f64, [k, d]: [f64; 2], observer: f64, gain: f64) -> f64 {
        let period = 1e-4;
        let observer = VelocityObserver::new(observer, period);
        let mut state = ObserverState::at_rest(1.0);
        let (mut now, mut before, mut told) = (0.0, 0.0, 0.0);
        let (mut work, mut square) = (0.0, 0.0);
        let angle = |tick: f64| (omega * period * tick).cos();
        let turns = (4.0 * core::f64::consts::TAU / (omega * period)).ceil() as u32;
        for tick in 0..20_000 + 50 * turns {
            let at = f64::from(tick);
            observer.update(&mut state, angle(at), 0.0);
            let demanded = -k * state.angle - d * state.velocity;
            // i[k+2] = i[k+1] − g i[k] + g u[k].
            let next = now + gain * (told - before);
            (before, now, told) = (now, next, demanded);
            if tick >= 20_000 {
                work += before * (angle(at + 1.0) - angle(at));
                square += 0.5 * (omega * omega) * period;
            }
        }
        work / square
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        /// The work of the law itself, by simulation, is a K + v D below half of Nyquist's frequency, where no other frequency of
        /// the held torque matters.
        #[test]
        fn the_factors_are_the_work_of_the_law(
            turn in 0.02..0.6_f64, observer in 800.0..5000.0_f64, gain in 0.15..0.45_f64,
        ) {
            let period = 1e-4;
            let pole = decay(observer * period);
            let [a, v] = factors(turn, period, pole, gain, 0.0);
            let omega = turn / period;
            for (law, wanted) in [([1.0, 0.0], a), ([0.0, 1e-3], 1e-3 * v)] {
                let found = given(omega, law, observer, gain);
                let scale = law[0] * 5e-4 + law[1];
                prop_assert!((found - wanted).abs() < 0.03 * scale, "{found} {wanted}");
            }
        }

        /// The controller's numbers are those of the desktop, on a grid sixteen times as fine.
        #[test]
        fn the_peaks_are_those_of_a_finer_grid(
            observer in 300.0..8000.0_f64, lag in 2.1e-4..2e-3_f64, latency in 0.0..1e-3_f64,
        ) {
            let period = 1e-4;
            let coarse = RenderingLag::new(
                period as f32, observer as f32, lag as f32, latency as f32,
            );
            let pole = decay(observer * period);
            let (mut a, mut v) = (0.0_f64, 0.0_f64);
            for k in 1..=16 * STEPS {
                let turn = core::f64::consts::PI * f64::from(k) / f64::from(16 * STEPS);
                let [at, vt] = factors(turn, period, pole, period / lag, latency);
                (a, v) = (a.max(at), v.max(vt));
            }
            prop_assert!(f64::from(coarse.stiffness) >= a && f64::from(coarse.stiffness) < 1.03 * a);
            prop_assert!(f64::from(coarse.damping) >= v && f64::from(coarse.damping) < 1.05 * v + 1e-6);
        }

        /// By the determinant: the load is 1 where diag(b) − JᵀMJ becomes singular; and one direction's greatest stiffness is
        /// where its load is 1.
        #[test]
        fn a_load_of_one_is_the_limit_of_the_condition(
            j in prop::array::uniform4(-0.2..0.2_f64), m in prop::array::uniform3(0.1..2.0_f64),
            b in prop::array::uniform2(1e-4..1e-2_f64), direction in 0.0..6.3_f64,
        ) {
            let jacobian = [Vector2::new(j[0], j[1]), Vector2::new(j[2], j[3])];
            prop_assume!(jacobian[0].cross_z(jacobian[1]).abs() > 1e-4);
            let joints = JointDamping::new(b);
            let demand = Symmetric { xx: m[0], xy: 0.4 * m[1].min(m[0]).min(m[2]), yy: m[2] };
            let load = joints.load(&demand, jacobian);
            let scaled = |by: f64| {
                let of = |p: usize, q: usize| jacobian[p].dot(&demand.apply(jacobian[q])) * by;
                [b[0] - of(0, 0), of(0, 1), b[1] - of(1, 1)]
            };
            let [xx, xy, yy] = scaled(1.0 / load);
            prop_assert!((xx * yy - xy * xy).abs() < 1e-6 * b[0] * b[1], "{load}");
            prop_assert!(xx > -1e-12 && yy > -1e-12);
            // One direction.
            let lag = RenderingLag { stiffness: 4e-4, damping: 0.4 };
            let [least, greatest] = lag.greatest_stiffness(&joints, jacobian);
            let u = Vector2::unit(direction);
            let along = Symmetric { xx: u.x * u.x, xy: u.x * u.y, yy: u.y * u.y };
            let one = joints.load(&lag.demand(&along, &Symmetric::isotropic(0.0)), jacobian);
            prop_assert!(least * (1.0 - 1e-9) <= 1.0 / one && 1.0 / one <= greatest * (1.0 + 1e-9));
            let all = lag.demand(&Symmetric::isotropic(least), &Symmetric::isotropic(0.0));
            prop_assert!((joints.load(&all, jacobian) - 1.0).abs() < 1e-9);
        }
    }
}
