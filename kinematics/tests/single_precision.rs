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
//! Inverse. The elbow errs by 2·4 ε·0.16 m/|sin| = 7.7e-8 m/|sin| at most, in angle by
//! that over 0.1 m; the arctangent adds up to 3e-7 rad. These worst cases do not meet:
//! where both elbows are bent by 37° or more (|sin| ≥ 0.6) no angle errs by 5e-7 rad.

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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    #[test]
    fn the_tip_is_within_its_bound_and_a_micrometre(
        theta1 in -3.1_f32..3.1, theta4 in -3.1_f32..3.1, left: bool
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
    fn driven_angles_are_within_their_bound(x in -0.2_f32..0.28, y in -0.26_f32..0.26) {
        let (single, double) = arms();
        for mode in WorkingMode::ALL {
            let c = Vec2::new(x, y);
            let Ok(exact) = double.inverse(widened(c), mode) else { continue };
            let sines = [exact.sin21().abs(), exact.sin34().abs()];
            if sines[0].min(sines[1]) < MARGIN {
                continue;
            }
            let [theta1, _, _, theta4] = single.inverse(c, mode).unwrap().angles();
            let [exact1, _, _, exact4] = exact.angles();
            for (angle, exact, sine) in [(theta1, exact1, sines[0]), (theta4, exact4, sines[1])] {
                let error = turned(f64::from(angle), exact).abs();
                prop_assert!(error <= 3e-7 + 7.7e-7 / sine, "{error:e} rad at sine {sine}");
                prop_assert!(sine < 0.6 || error <= 5e-7, "{error:e} rad at sine {sine}");
            }
        }
    }

    #[test]
    fn torques_are_within_a_hundred_thousandth(
        theta1 in -3.1_f32..3.1, theta4 in -3.1_f32..3.1,
        omega in prop::array::uniform2(-5.0_f32..5.0), alpha in prop::array::uniform2(-50.0_f32..50.0)
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
