//! C and the driving torques from the driven angles, on an arm of the default's size.
//!
//! With lengths l ≤ 0.16 m: sines and cosines err by 9e-8 (1.5 ε), so B and D by 1.5 ε l1 √2
//! and the rounding of their coordinates, together 3 ε·0.1 m each. The rounding of the
//! intersection displaces its two circles by about 4 ε·0.16 m. Circles displaced by δ move their
//! common point by 2 δ/|sin(θ3−θ2)|, so C errs by at most
//! 2 (3·0.1·2 + 4·0.16) ε / |sin| = 1.5e-7 m/|sin|.

use crate::arms::{BENCHTOP, single, wide};
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Pose, Side};
use fivebar_kinematics::{PlanarVector, Scalar};
use fivebar_testkit::side;
use nalgebra::Vector2;
use proptest::prelude::*;

/// The margin from singularities, of the size that arms have in their settings.
const MARGIN: f64 = 0.2;

/// The benchtop arm in both precisions.
fn geometries() -> (Geometry<f32>, Geometry<f64>) {
    let single = Geometry::new(BENCHTOP).unwrap();
    (single, Geometry::new(BENCHTOP.map(f64::from)).unwrap())
}

/// Driven angles and an assembly mode for which B, C and D are at least [`MARGIN`] from a line in
/// double precision, and the pose.
fn poses() -> impl Strategy<Value = ([f32; 2], Side, Pose<f64>)> {
    let angle = || single(-3.1..3.1);
    ([angle(), angle()], side()).prop_filter_map("no such pose", |(theta, assembly)| {
        let (_, double) = geometries();
        let [theta1, theta4] = theta.map(f64::from);
        let exact = double.forward(theta1, theta4, assembly).ok()?;
        (exact.sin32().abs() >= MARGIN).then_some((theta, assembly, exact))
    })
}

fn arm<S: Scalar>(geometry: Geometry<S>) -> Arm<S> {
    // Through f32, so that both arms hold the same numbers.
    let number = |value: f32| S::from_f64(f64::from(value));
    let link = Link {
        mass: number(0.1),
        com: Vector2::new(number(0.05), number(0.002)),
        inertia: number(1e-4),
    };
    let gravity = Vector2::new(number(0.0), number(-9.81));
    Arm::new(
        geometry,
        [link; 4],
        number(0.05),
        gravity,
        [number(1e-5); 2],
    )
    .unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    /// All 4096 poses are accepted.
    #[test]
    fn the_tip_is_within_its_bound_and_a_micrometre((theta, assembly, exact) in poses()) {
        let (single, _) = geometries();
        let pose = single.forward(theta[0], theta[1], assembly).unwrap();
        let (error, sine) = ((wide(pose.c) - exact.c).length(), exact.sin32().abs());
        prop_assert!(error <= 1.5e-7 / sine, "{error:e} m at sine {sine}");
        prop_assert!(error < 1e-6);
    }

    /// All 4096 poses are accepted.
    #[test]
    fn torques_are_within_a_hundred_thousandth(
        (theta, assembly, exact) in poses(),
        omega in prop::array::uniform2(single(-5.0..5.0)), alpha in prop::array::uniform2(single(-50.0..50.0))
    ) {
        let (single, double) = geometries();
        let pose = single.forward(theta[0], theta[1], assembly).unwrap();
        let torque = {
            let rates = single.forward_velocities(&pose, omega[0], omega[1]).unwrap();
            let acc = single.forward_accelerations(&pose, &rates, alpha[0], alpha[1]).unwrap();
            arm(single).inverse_dynamics(&pose, &rates, &acc, Vector2::zeros()).unwrap()
        };
        let [omega1, omega4] = omega.map(f64::from);
        let [alpha1, alpha4] = alpha.map(f64::from);
        let rates = double.forward_velocities(&exact, omega1, omega4).unwrap();
        let acc = double.forward_accelerations(&exact, &rates, alpha1, alpha4).unwrap();
        let expected = arm(double).inverse_dynamics(&exact, &rates, &acc, Vector2::zeros()).unwrap();
        // The terms that cancel are as large as the torques for the distal links' accelerations.
        let fastest = acc.alpha.iter().chain(&rates.omega).fold(1.0_f64, |m, a| m.max(a.abs()));
        let spin = rates.omega.iter().fold(0.0_f64, |m, w| m.max(w * w));
        let size = 1e-3 * (fastest + spin) / exact.sin32().powi(2) + 1.0;
        for (actual, expected) in torque.into_iter().zip(expected) {
            prop_assert!((f64::from(actual) - expected).abs() <= 1e-5 * size);
        }
    }
}
