//! What the tip of an arm can at a point: torque, speed, stiffness and error.
//!
//! With θ̇ = J⁻¹ ṙ, the rows r1 and r4 of J⁻¹, and det = r1 × r4:
//!
//! - τ = Jᵀ F, and the columns of J have the lengths |r4|/|det| and |r1|/|det|: a force of 1 N in the
//!   worst direction takes a torque of max(|r1|, |r4|)/|det|.
//! - In every direction the tip has a speed of 1/max(|r1|, |r4|) with no motor above 1 rad/s.
//! - With drives of stiffness k, K = J⁻ᵀ k J⁻¹: the least stiffness of the tip is k σmin(J⁻¹)².
//! - The error is `fivebar accuracy`'s: √(σx² + σy²) by [`ToolSensitivities`], from the middle of the base.

use super::condition::Condition;
use crate::accuracy::five_bar::ToolSensitivities;
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
#[non_exhaustive]
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

/// Where an arm is the worst in its work area, by 1/κ and by each measure, as C from A [m].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct WorstPoints {
    /// By 1/κ.
    pub dexterity: [f64; 2],
    /// By [`Measures::torque`].
    pub torque: [f64; 2],
    /// By [`Measures::speed`].
    pub speed: [f64; 2],
    /// By [`Measures::stiffness`].
    pub stiffness: [f64; 2],
    /// By [`Measures::error`].
    pub error: [f64; 2],
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
    let [near1, near4] = at.legs.map(|leg| leg.foot - leg.far);
    let [far2, far3] = at.legs.map(|leg| leg.far);
    let directions = [near1, far2, far3, near4].map(|link| link / link.norm());
    ToolSensitivities::of_links(directions, [near1.norm(), near4.norm()])
        .map_or(f64::INFINITY, |by| {
            by.radial_deviation([tolerance.angle; 2], [tolerance.length; 5])
        })
}

#[cfg(test)]
mod tests {
    use super::super::condition::condition;
    use super::*;
    use crate::accuracy::five_bar::{ArmTolerance, TolerancedArm, ToolState, analyse};
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

    /// By directions, tried one by one, with the Jacobian of the kinematics; more of them beside the worst.
    fn by_directions(jacobian: Matrix2<f64>) -> [f64; 3] {
        const STEP: f64 = TAU / 2_000.0;
        let inverse = jacobian.try_inverse().unwrap();
        let figures = |angle: f64| {
            let direction = Vector2::new(angle.cos(), angle.sin());
            let rate = inverse * direction;
            [
                jacobian.tr_mul(&direction).amax(),
                -1.0 / rate.amax(),
                -rate.norm_squared(),
            ]
        };
        let most = |figure: usize, middle: f64, reach: f64| {
            let angles = (-1_000..=1_000).map(|i| middle + reach * f64::from(i) / 1_000.0);
            angles
                .map(|angle| (figures(angle)[figure], angle))
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap()
        };
        [0, 1, 2].map(|figure| {
            let (_, worst) = most(figure, 0.0, 1_000.0 * STEP);
            most(figure, worst, STEP).0.abs()
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
                .map(|c| c - Vector2::new(0.5 * base, 0.0))
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
    fn the_error_is_that_of_the_analysis_of_accuracy() {
        let tolerance = ArmTolerance {
            length_sd: [TOLERANCE.length; 5],
            input_sd: [TOLERANCE.angle; 2],
            ..ArmTolerance::default()
        };
        let reached = Tally::default();
        proptest!(|(geometry in geometry(), x in -0.5..0.5_f64, y in -0.5..0.5_f64)| {
            let c = Vector2::new(x, y);
            let Ok(here) = condition(geometry.lengths(), c) else { return Ok(()) };
            let arm = TolerancedArm {
                geometry: &geometry,
                arm: None,
                working_mode: MODE,
                tolerance: &tolerance,
            };
            let Ok(analysis) = analyse(&arm, &ToolState::at_rest(c)) else { return Ok(()) };
            prop_assume!(analysis.pose.nearest_singularity().1 > 1e-3);
            let (found, expected) = (error(&here, TOLERANCE), analysis.radial_deviation());
            prop_assert!((found - expected).abs() < 1e-9 * expected, "{found} {expected}");
            reached.count(true);
        });
        assert!(reached.accepted() > 40);
    }

    #[test]
    fn a_symmetric_arm_errs_alike_on_both_sides() {
        let lengths = [0.1, 0.16, 0.16, 0.1, 0.08];
        let at = |x: f64| {
            error(
                &condition(lengths, Vector2::new(0.04 + x, 0.2)).unwrap(),
                TOLERANCE,
            )
        };
        for x in [0.01, 0.05, 0.09] {
            assert!(
                (at(x) - at(-x)).abs() < 1e-12 * at(x),
                "{} {}",
                at(x),
                at(-x)
            );
        }
        assert!((at(0.09) - at(0.01)).abs() > 0.01 * at(0.01));
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
