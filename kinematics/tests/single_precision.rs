//! `f32` against `f64` on an arm of the default's size, from the same angles and points.
//!
//! With ε = 2⁻²⁴, half the distance of neighbours at 1, and lengths l ≤ 0.16 m:
//!
//! Forward. Sines and cosines err by 9e-8 (1.5 ε), so B and D by 1.5 ε l1 √2 and the
//! rounding of their coordinates, together 3 ε·0.1 m each. The rounding of the
//! intersection displaces its two circles by about 4 ε·0.16 m. What displaces the
//! circles by δ moves their common point by 2 δ/|sin(θ3−θ2)|, so C errs by at most
//! 2 (3·0.1·2 + 4·0.16) ε / |sin| = 1.5e-7 m/|sin|.
//!
//! Inverse. C is a given number, so only the solution errs. Near a stretched leg the small
//! rest s² − |p|² decides, s = n + f being the sum of the lengths. It is taken from exact
//! squares to 3·2⁻²⁸ s², which moves the elbow by less than ε s/|sin|/5. Near a folded leg
//! |p|² − (n − f)² decides, whose rounding by 2 ε |p|² moves the elbow by ε |p| s²/(4 n f
//! |sin|): little for legs of alike lengths, for then |p| is small. The rest of the solution
//! rounds some five times by ε at most, and the arctangent adds up to 3e-7 rad. These worst
//! cases hardly ever meet. Where the elbow is bent by |sin| ≥ 0.15, the margin that the
//! controller keeps, and towards the stretched leg by ≥ 0.05, the greatest error of a driven
//! angle among 7e8 random ones was 4.5e-7 rad for legs of which no link is longer than 1.4
//! times the other, and 6.7e-7 rad for those up to 1.8 times, as in every built-in robot.

mod common;

use common::turned;
use fivebar_kinematics::Vec2;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
use proptest::prelude::*;

const LENGTHS: [f32; 5] = [0.1, 0.16, 0.16, 0.1, 0.08];
/// Away from singularities: the margin that arms keep by their settings is of this size.
const MARGIN: f64 = 0.2;

fn arms() -> (Geometry<f32>, Geometry<f64>) {
    let single = Geometry::new(LENGTHS).unwrap();
    (single, Geometry::new(LENGTHS.map(f64::from)).unwrap())
}

fn widened(v: Vec2<f32>) -> Vec2<f64> {
    Vec2::new(f64::from(v.x), f64::from(v.y))
}

/// The driven angles with C at `c` [m] are within their leg's bound [rad] of the exact ones,
/// for every leg that is bent enough.
fn assert_angles(
    single: &Geometry<f32>,
    double: &Geometry<f64>,
    c: Vec2<f32>,
    mode: WorkingMode,
    bounds: [f64; 2],
) -> Result<(), TestCaseError> {
    let (Ok(pose), Ok(exact)) = (single.inverse(c, mode), double.inverse(widened(c), mode)) else {
        return Ok(());
    };
    let ([theta1, _, _, theta4], [exact1, _, _, exact4]) = (pose.angles(), exact.angles());
    let cosines = [exact.u1.dot(exact.u2), exact.u4.dot(exact.u3)];
    let sines = [exact.sin21().abs(), exact.sin34().abs()];
    for (leg, (angle, exact)) in [(theta1, exact1), (theta4, exact4)].into_iter().enumerate() {
        let least = if cosines[leg] > 0.0 { 0.05 } else { 0.15 };
        let (error, sine) = (turned(f64::from(angle), exact).abs(), sines[leg]);
        prop_assert!(
            sine < least || error <= bounds[leg],
            "{error:e} rad at sine {sine}"
        );
    }
    Ok(())
}

/// Numbers of a range, in single precision. (The strategy for ranges of `f32` itself now and
/// then steps over a bound and panics.)
fn single(range: core::ops::Range<f64>) -> impl Strategy<Value = f32> {
    range.prop_map(|number| number as f32)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    #[test]
    fn the_tip_is_within_its_bound_and_a_micrometre(
        theta1 in single(-3.1..3.1), theta4 in single(-3.1..3.1), left: bool
    ) {
        let assembly = if left { Side::Left } else { Side::Right };
        let (single, double) = arms();
        let Ok(exact) = double.forward(theta1.into(), theta4.into(), assembly) else {
            return Ok(());
        };
        let sine = exact.sin32().abs();
        if sine < MARGIN {
            return Ok(());
        }
        let pose = single.forward(theta1, theta4, assembly).unwrap();
        let error = (widened(pose.c) - exact.c).norm();
        prop_assert!(error <= 1.5e-7 / sine, "{error:e} m at sine {sine}");
        prop_assert!(error < 1e-6);
    }

    #[test]
    fn driven_angles_of_the_benchtop_arm_are_within_half_a_millionth(
        x in single(-0.2..0.28), y in single(-0.26..0.26)
    ) {
        let (single, double) = arms();
        for mode in WorkingMode::ALL {
            assert_angles(&single, &double, Vec2::new(x, y), mode, [5e-7; 2])?;
        }
    }

    #[test]
    fn driven_angles_of_any_arm_are_within_half_a_millionth_or_a_little_more(
        size in single(-5.0..3.0), ratios in prop::array::uniform2(single(1.0 / 1.8..1.8)),
        base in single(0.1..1.5), l4 in single(0.7..1.4),
        theta in -3.1_f64..3.1, sine in 0.05_f64..0.5, left: bool, folded: bool,
    ) {
        // Leg 1 bent by little, so that each case is a hard one; leg 4 as it comes.
        let lengths = [1.0, ratios[0], l4 * ratios[1], l4, base].map(|it| it * size.exp());
        let Ok(single) = Geometry::new(lengths) else { return Ok(()) };
        let double = Geometry::new(lengths.map(f64::from)).unwrap();
        let turn = if folded { std::f64::consts::PI - sine.asin() } else { sine.asin() };
        let theta2 = theta + if left { turn } else { -turn };
        let c = Vec2::unit(theta) * double.l1() + Vec2::unit(theta2) * double.l2();
        let alike = |ratio: f32| ratio.max(1.0 / ratio) <= 1.4;
        let bounds = ratios.map(|ratio| if alike(ratio) { 5e-7 } else { 7e-7 });
        for mode in WorkingMode::ALL {
            assert_angles(&single, &double, Vec2::new(c.x as f32, c.y as f32), mode, bounds)?;
        }
    }

    #[test]
    fn torques_are_within_a_hundred_thousandth(
        theta1 in single(-3.1..3.1), theta4 in single(-3.1..3.1),
        omega in prop::array::uniform2(single(-5.0..5.0)), alpha in prop::array::uniform2(single(-50.0..50.0))
    ) {
        let (single, double) = arms();
        let Ok(exact) = double.forward(theta1.into(), theta4.into(), Side::Left) else {
            return Ok(());
        };
        if exact.nearest_singularity().1 < MARGIN {
            return Ok(());
        }
        let pose = single.forward(theta1, theta4, Side::Left).unwrap();
        let torque = {
            let rates = single.forward_velocities(&pose, omega[0], omega[1]).unwrap();
            let acc = single.forward_accelerations(&pose, &rates, alpha[0], alpha[1]).unwrap();
            arm(single).inverse_dynamics(&pose, &rates, &acc, Vec2::zero()).unwrap()
        };
        let [omega1, omega4] = omega.map(f64::from);
        let [alpha1, alpha4] = alpha.map(f64::from);
        let rates = double.forward_velocities(&exact, omega1, omega4).unwrap();
        let acc = double.forward_accelerations(&exact, &rates, alpha1, alpha4).unwrap();
        let expected = arm(double).inverse_dynamics(&exact, &rates, &acc, Vec2::zero()).unwrap();
        // The parts that cancel are as large as the distal links' accelerations ask for.
        let fastest = acc.alpha.iter().chain(&rates.omega).fold(1.0_f64, |m, a| m.max(a.abs()));
        let spin = rates.omega.iter().fold(0.0_f64, |m, w| m.max(w * w));
        let size = 1e-3 * (fastest + spin) / exact.sin32().powi(2) + 1.0;
        for (actual, expected) in torque.into_iter().zip(expected) {
            prop_assert!((f64::from(actual) - expected).abs() <= 1e-5 * size);
        }
    }
}

fn arm<S: fivebar_kinematics::Scalar>(geometry: Geometry<S>) -> Arm<S> {
    // Through f32, so that both arms hold the same numbers.
    let number = |value: f32| S::from_f64(f64::from(value));
    let link = Link {
        mass: number(0.1),
        com: Vec2::new(number(0.05), number(0.002)),
        inertia: number(1e-4),
    };
    let gravity = Vec2::new(number(0.0), number(-9.81));
    Arm::new(
        geometry,
        [link; 4],
        number(0.05),
        gravity,
        [number(1e-5); 2],
    )
    .unwrap()
}
