//! What the tip of an arm can at a point: torque, speed, stiffness and error.
//!
//! With θ̇ = J⁻¹ ṙ, the rows r1 and r4 of J⁻¹, and det = r1 × r4:
//!
//! - τ = Jᵀ F, and the columns of J have the lengths |r4|/|det| and |r1|/|det|: a force of 1 N in the
//!   worst direction takes a torque of max(|r1|, |r4|)/|det|.
//! - In every direction the tip has a speed of 1/max(|r1|, |r4|) with no motor above 1 rad/s.
//! - With drives of stiffness k, K = J⁻ᵀ k J⁻¹: the least stiffness of the tip is k σmin(J⁻¹)².
//! - u2 and u3 are the directions of the far links, n1 and n4 those of the near ones. From |C − B| = l2,
//!   u2·δC = δl2 + (u2·n1) δl1 + l1 (n1 × u2) δθ1, and alike for l3, with the base's error. Independent
//!   errors of standard deviations s2, s3 of both right sides give an RMS error of √(s2² + s3²)/|u2 × u3|.

use super::condition::Condition;
use fivebar_kinematics::PlanarVector;
use serde::{Deserialize, Serialize};

/// What counts at the worst point of a work area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Measure {
    /// The torque of a motor for a force at the tip, to be the least.
    Torque,
    /// The speed of the tip in every direction, to be the greatest.
    Speed,
    /// The stiffness of the tip against a force, to be the greatest.
    Stiffness,
    /// The error of the tip under the stated tolerances, to be the least.
    Error,
}

/// Standard deviations of an arm's errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerance {
    /// Of each link's length and the base [m].
    pub length: f64,
    /// Of each driven joint's angle [rad].
    pub angle: f64,
}

/// The measures at the worst point of a work area.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measures {
    /// Torque of a motor for a force of 1 N in the worst direction [N·m].
    pub torque: f64,
    /// Speed of the tip in the slowest direction with no motor above 1 rad/s [m/s].
    pub speed: f64,
    /// Least stiffness of the tip with drives of 1 N·m/rad each [N/m].
    pub stiffness: f64,
    /// RMS error of the tip under the tolerances [m].
    pub error: f64,
}

impl Measure {
    /// All of them.
    pub(super) const ALL: [Self; 4] = [Self::Torque, Self::Speed, Self::Stiffness, Self::Error];

    /// The measure at a point, or its negative where the least is wanted.
    pub(super) fn merit(self, at: &Condition, tolerance: Tolerance) -> f64 {
        let [row1, row4] = at.inverse_jacobian();
        let longer = row1.norm().max(row4.norm());
        let det = row1.cross_z(row4).abs();
        match self {
            Self::Torque => -longer / det,
            Self::Speed => 1.0 / longer,
            Self::Stiffness => {
                let squares = row1.norm_squared() + row4.norm_squared();
                let sum = (squares + 2.0 * det).sqrt();
                let difference = (squares - 2.0 * det).max(0.0).sqrt();
                (0.5 * (sum - difference)).powi(2)
            }
            Self::Error => -error(at, tolerance),
        }
    }
}

impl Measures {
    pub(super) fn of_merits([torque, speed, stiffness, error]: [f64; 4]) -> Self {
        Self {
            torque: -torque,
            speed,
            stiffness,
            error: -error,
        }
    }
}

fn error(at: &Condition, tolerance: Tolerance) -> f64 {
    let variances = at.legs.map(|leg| {
        let near = leg.foot - leg.far;
        let far = leg.far / leg.far.norm();
        let along = far.dot(&near) / near.norm();
        let by_angle = near.cross_z(far) * tolerance.angle;
        (1.0 + along * along) * tolerance.length.powi(2) + by_angle * by_angle
    });
    let [_, far4] = at.legs.map(|leg| leg.far / leg.far.norm());
    let by_base = (far4.x * tolerance.length).powi(2);
    (variances[0] + variances[1] + by_base).sqrt() / at.sine.abs()
}

#[cfg(test)]
mod tests {
    use super::super::condition::condition;
    use super::*;
    use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
    use fivebar_testkit::{Tally, geometry};
    use nalgebra::{Matrix2, Vector2};
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    const MODE: WorkingMode = WorkingMode::new(Side::Right, Side::Left);
    const TOLERANCE: Tolerance = Tolerance {
        length: 1e-4,
        angle: 2e-4,
    };

    /// By directions, tried one by one, with the Jacobian of the kinematics.
    fn by_directions(jacobian: Matrix2<f64>) -> [f64; 3] {
        let directions = (0..20_000).map(|i| TAU * f64::from(i) / 20_000.0);
        let inverse = jacobian.try_inverse().unwrap();
        directions.fold([0.0, f64::INFINITY, f64::INFINITY], |worst, angle| {
            let direction = Vector2::new(angle.cos(), angle.sin());
            let (torque, rate) = (jacobian.tr_mul(&direction), inverse * direction);
            [
                worst[0].max(torque.amax()),
                worst[1].min(1.0 / rate.amax()),
                worst[2].min(rate.norm_squared()),
            ]
        })
    }

    /// By differences of the forward solution, each length and angle changed by itself.
    fn by_differences(lengths: [f64; 5], c: Vector2<f64>) -> Option<f64> {
        let at = |lengths: [f64; 5], turned: [f64; 2]| {
            let [l1, l2, l3, l4, base] = lengths;
            let b = turned[0];
            let d = turned[1];
            let b = Vector2::new(l1 * b.cos(), l1 * b.sin());
            let d = Vector2::new(base + l4 * d.cos(), l4 * d.sin());
            let (span, q) = (d - b, (d - b).norm_squared());
            let along = 0.5 * (1.0 + (l2 * l2 - l3 * l3) / q);
            let height = (l2 * l2 / q - along * along).sqrt();
            let both = [1.0, -1.0]
                .map(|side| b + span * along + Vector2::new(-span.y, span.x) * (side * height));
            both.into_iter()
                .min_by(|a, b| (a - c).norm().total_cmp(&(b - c).norm()))
        };
        let pose = Geometry::new(lengths).ok()?.inverse(c, MODE).ok()?;
        let angle = |from: Vector2<f64>, to: Vector2<f64>| (to.y - from.y).atan2(to.x - from.x);
        let e = Vector2::new(lengths[4], 0.0);
        let angles = [angle(Vector2::zeros(), pose.b), angle(e, pose.d)];
        let step = 1e-7;
        let mut variance = 0.0;
        for index in 0..7 {
            let [low, high] = [-step, step].map(|by| {
                let (mut lengths, mut angles) = (lengths, angles);
                match index {
                    0..5 => lengths[index] += by,
                    _ => angles[index - 5] += by,
                }
                at(lengths, angles)
            });
            let slope = (high? - low?) / (2.0 * step);
            let deviation = if index < 5 {
                TOLERANCE.length
            } else {
                TOLERANCE.angle
            };
            variance += (slope * deviation).norm_squared();
        }
        Some(variance.sqrt())
    }

    #[test]
    fn each_is_that_of_the_jacobian_in_all_directions_and_of_differences() {
        let reached = Tally::default();
        proptest!(|(geometry in geometry(), x in -0.5..0.5_f64, y in -0.5..0.5_f64)| {
            let c = Vector2::new(x, y);
            let Ok(here) = condition(geometry.lengths(), c) else { return Ok(()) };
            let pose = geometry.inverse(c, MODE).unwrap();
            prop_assume!(pose.nearest_singularity().1 > 0.03);
            let jacobian = geometry.jacobian(&pose).unwrap().matrix();
            let tried = by_directions(jacobian);
            let found = Measure::ALL.map(|measure| measure.merit(&here, TOLERANCE));
            let found = Measures::of_merits(found);
            for (found, tried) in [found.torque, found.speed, found.stiffness].into_iter().zip(tried) {
                prop_assert!((found - tried).abs() < 1e-3 * tried, "{found} {tried}");
            }
            let tried = by_differences(geometry.lengths(), c).unwrap();
            prop_assert!((found.error - tried).abs() < 1e-4 * tried, "{} {tried}", found.error);
            reached.count(true);
        });
        assert!(reached.accepted() > 40);
    }
}
