//! The five-bar's errors: published figures, automatic differentiation, and samples that
//! must never exceed the exact worst case.

use fivebar_design::accuracy::five_bar::{
    clearance_error, tool_sensitivities, tool_with_pin_offsets, worst_input_error,
};
use fivebar_design::accuracy::{DifferentiableModel, sensitivities};
use fivebar_kinematics::five_bar::{Geometry, Pose, PoseError, Side, WorkingMode};
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;
use proptest::prelude::*;

/// All links .23 m on a base of .275 m, C at (0, .25) from the middle of the base.
fn example() -> (Geometry<f64>, Pose<f64>) {
    let geometry = Geometry::new([0.23, 0.23, 0.23, 0.23, 0.275]).unwrap();
    let elbows_out = WorkingMode::new(Side::Right, Side::Left);
    let pose = geometry
        .inverse(Vector2::new(0.1375, 0.25), elbows_out)
        .unwrap();
    assert_eq!(pose.assembly(), Side::Left);
    (geometry, pose)
}

/// Asserts equality in all printed digits, `places` of them after the point, in micrometres.
#[track_caller]
fn assert_microns(actual: f64, expected: f64) {
    assert!(
        (actual * 1e6 - expected).abs() <= 0.005,
        "{} for {expected} µm",
        actual * 1e6
    );
}

#[test]
fn the_worst_of_two_angle_errors() {
    let (geometry, pose) = example();
    assert_microns(
        worst_input_error(&geometry, &pose, [2e-4; 2]).unwrap(),
        271.38,
    );
}

#[test]
fn the_scatter_of_five_lengths() {
    let (geometry, pose) = example();
    let by = tool_sensitivities(&geometry, &pose).unwrap().lengths;
    let deviation = |part: fn(&Vector2<f64>) -> f64| {
        by.iter()
            .map(|v| (20e-6 * part(v)).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    assert_microns(deviation(|v| v.x), 14.72);
    assert_microns(deviation(|v| v.y), 106.05);
}

#[test]
fn the_worst_and_the_mean_of_five_clearances() {
    let (geometry, pose) = example();
    let error = clearance_error(&geometry, &pose, [10e-6; 5]).unwrap();
    assert_microns(error.worst_linear, 151.18);
    assert_microns(error.worst, 151.47);
    assert_microns(error.rms, 48.45);
}

/// C from the middle of the base by θ1, θ4, l1…l5.
struct Tool(Side);

impl DifferentiableModel for Tool {
    type Error = PoseError;

    fn evaluate<S: Scalar>(&self, p: &[S]) -> Result<Vec<S>, PoseError> {
        let lengths = [p[2], p[3], p[4], p[5], p[6]];
        let geometry = Geometry::new(lengths).map_err(|_| PoseError::NotFinite)?;
        let c = geometry.forward(p[0], p[1], self.0)?.c;
        Ok(vec![c.x - S::HALF * p[6], c.y])
    }
}

fn posed_arm() -> impl Strategy<Value = (Geometry<f64>, Pose<f64>)> {
    let lengths = prop::array::uniform5(0.05..0.3_f64);
    let angles = prop::array::uniform2(-3.1..3.1_f64);
    (lengths, angles, any::<bool>()).prop_filter_map(
        "poses well clear of type 2",
        |(l, q, left)| {
            let geometry = Geometry::new(l).ok()?;
            let side = if left { Side::Left } else { Side::Right };
            let pose = geometry.forward(q[0], q[1], side).ok()?;
            (pose.sin32().abs() > 0.2).then_some((geometry, pose))
        },
    )
}

proptest! {
    #[test]
    fn analytic_sensitivities_equal_dual_numbers((geometry, pose) in posed_arm()) {
        let [theta1, _, _, theta4] = pose.angles();
        let [l1, l2, l3, l4, base] = geometry.lengths();
        let t = sensitivities(&Tool(pose.assembly()), &[theta1, theta4, l1, l2, l3, l4, base]).unwrap();
        let analytic = tool_sensitivities(&geometry, &pose).unwrap();
        let columns = analytic.inputs.iter().chain(&analytic.lengths);
        for (column, by) in columns.enumerate() {
            prop_assert!((t[(0, column)] - by.x).abs() < 1e-11 * (1.0 + by.length()));
            prop_assert!((t[(1, column)] - by.y).abs() < 1e-11 * (1.0 + by.length()));
        }
    }

    #[test]
    fn no_sample_exceeds_the_exact_worst_case(
        (geometry, pose) in posed_arm(),
        radii in prop::array::uniform5(0.0..50e-6_f64),
        directions in prop::array::uniform5(-3.2..3.2_f64),
        shares in prop::array::uniform5(0.0..=1.0_f64),
        inputs in prop::array::uniform2(-1.0..=1.0_f64),
    ) {
        let worst = clearance_error(&geometry, &pose, radii).unwrap();
        let offsets = [0, 1, 2, 3, 4].map(|i| Vector2::unit(directions[i]) * (radii[i] * shares[i]));
        let error = (tool_with_pin_offsets(&geometry, &pose, offsets).unwrap() - pose.c).length();
        prop_assert!(error <= worst.worst * (1.0 + 1e-9) + 1e-15);
        // The linear worst case w differs from the exact one by terms of second order. C moves
        // by at most 2w relative to the centres of its two circles. Over that distance a circle
        // leaves its tangent by (2w)²/2l, and both displace C by 1/|sin| times their sum.
        let [_, l2, l3, ..] = geometry.lengths();
        let twice = 2.0 * worst.worst;
        let second = twice * twice / (l2.min(l3) * pose.sin32().abs());
        prop_assert!((worst.worst - worst.worst_linear).abs() <= second + 1e-15);

        let greatest = 3e-4;
        let [theta1, _, _, theta4] = pose.angles();
        let displaced = geometry
            .forward(theta1 + greatest * inputs[0], theta4 + greatest * inputs[1], pose.assembly())
            .unwrap();
        let worst = worst_input_error(&geometry, &pose, [greatest; 2]).unwrap();
        prop_assert!((displaced.c - pose.c).length() <= worst * (1.0 + 1e-9));
    }
}
