//! Forces under tolerance, seated pins and tolerance allocation on random arms.

use fivebar_design::accuracy::allocation::{ToleranceClass, allocate};
use fivebar_design::accuracy::arm::{ArmAccuracyModel, DrivenJointMotion};
use fivebar_design::accuracy::clearance_equilibrium::clearance_equilibrium;
use fivebar_design::accuracy::five_bar::{clearance_error, tool_sensitivities};
use fivebar_design::accuracy::{DifferentiableModel, sensitivities};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
use fivebar_testkit::Tally;
use nalgebra::Vector2;
use proptest::prelude::*;

fn arm(lengths: [f64; 5], mass: f64) -> Arm<f64> {
    let link = |length: f64| Link {
        mass,
        com: Vector2::new(0.45 * length, 0.02 * length),
        inertia: mass * length * length / 12.0,
    };
    let [l1, l2, l3, l4, _] = lengths;
    let geometry = Geometry::new(lengths).unwrap();
    let links = [l1, l2, l3, l4].map(link);
    Arm::new(
        geometry,
        links,
        0.1 * mass,
        Vector2::new(0.0, -9.81),
        [1e-4; 2],
    )
    .unwrap()
}

fn state() -> impl Strategy<Value = (Arm<f64>, Side, DrivenJointMotion)> {
    let lengths = prop::array::uniform5(0.08..0.2_f64);
    let theta = prop::array::uniform2(-3.1..3.1_f64);
    let omega = prop::array::uniform2(-5.0..5.0_f64);
    let alpha = prop::array::uniform2(-50.0..50.0_f64);
    (lengths, theta, omega, alpha, any::<bool>()).prop_filter_map(
        "poses clear of type 2",
        |(lengths, theta, omega, alpha, left)| {
            let side = if left { Side::Left } else { Side::Right };
            let pose = Geometry::new(lengths)
                .ok()?
                .forward(theta[0], theta[1], side)
                .ok()?;
            let inputs = DrivenJointMotion {
                theta,
                omega,
                alpha,
            };
            (pose.sin32().abs() > 0.3).then(|| (arm(lengths, 0.2), side, inputs))
        },
    )
}

proptest! {
    #[test]
    fn every_derivative_of_the_arm_meets_its_difference((arm, assembly, inputs) in state()) {
        let model = ArmAccuracyModel { arm: &arm, assembly, external_force: Vector2::new(1.0, -2.0) };
        let nominal = model.primitives(&inputs);
        let t = sensitivities(&model, &nominal).unwrap();
        for column in 0..nominal.len() {
            let step = 1e-6 * nominal[column].abs().max(0.05);
            let moved = |by: f64| {
                let mut primitives = nominal;
                primitives[column] += by;
                model.evaluate(&primitives).unwrap()
            };
            let (up, down) = (moved(step), moved(-step));
            prop_assert!(t.column(column).amax() > 0.0);
            for row in 0..up.len() {
                let difference = (up[row] - down[row]) / (2.0 * step);
                let scale = t.column(column).amax().max(t.row(row).amax());
                prop_assert!((difference - t[(row, column)]).abs() < 1e-5 * scale);
            }
        }
        let pose = arm.geometry().forward(inputs.theta[0], inputs.theta[1], assembly).unwrap();
        let analytic = tool_sensitivities(arm.geometry(), &pose).unwrap();
        for (column, by) in (0..2).chain(6..11).zip(analytic.inputs.iter().chain(&analytic.lengths)) {
            prop_assert!((t[(0, column)] - by.x).abs() < 1e-11 * (1.0 + by.length()));
            prop_assert!((t[(1, column)] - by.y).abs() < 1e-11 * (1.0 + by.length()));
        }
    }
}

#[test]
fn seated_pins_stay_within_the_worst_case() {
    let settled = Tally::default();
    proptest!(|((arm, assembly, inputs) in state())| {
        let radii = [10e-6, 20e-6, 5e-6, 15e-6, 10e-6];
        let pose = arm.geometry().forward(inputs.theta[0], inputs.theta[1], assembly).unwrap();
        let worst = clearance_error(arm.geometry(), &pose, radii).unwrap().worst;
        let equilibrium = clearance_equilibrium(&arm, assembly, &inputs, Vector2::zeros(), radii).unwrap();
        prop_assert!(equilibrium.displacement.length() <= worst * (1.0 + 1e-9));
        for (offset, radius) in equilibrium.offsets.iter().zip(radii) {
            prop_assert!((offset.length() - radius).abs() < 1e-12);
        }
        if settled.count(equilibrium.converged) {
            // Every pin lies where its force presses it.
            for (i, sign) in [(0, -1.0), (1, -1.0), (2, 1.0), (3, -1.0), (4, -1.0)] {
                let (offset, force) = (equilibrium.offsets[i], equilibrium.reactions[i]);
                prop_assert!((offset.dot(&force) - sign * offset.length() * force.length()).abs() < 1e-9 * force.length());
            }
        }
    });
    settled.assert_accepted(0.95);
}

#[test]
fn allocation_finds_what_trying_everything_finds() {
    let possible = Tally::default();
    let weights = prop::collection::vec(prop::collection::vec(0.0..4.0_f64, 4), 3);
    proptest!(|(weights in weights, limit in 0.05..4.0_f64)| {
        let classes = vec![
            vec![
                ToleranceClass { deviation: 1.0, cost: 1.0 },
                ToleranceClass { deviation: 0.5, cost: 2.5 },
                ToleranceClass { deviation: 0.2, cost: 7.0 },
            ];
            4
        ];
        let mut cheapest = f64::INFINITY;
        for code in 0..81_usize {
            let choice = [code % 3, code / 3 % 3, code / 9 % 3, code / 27];
            let fits = weights.iter().all(|row| {
                let variance: f64 = (0..4).map(|i| row[i] * classes[i][choice[i]].deviation.powi(2)).sum();
                variance <= limit
            });
            let cost: f64 = (0..4).map(|i| classes[i][choice[i]].cost).sum();
            if fits {
                cheapest = cheapest.min(cost);
            }
        }
        let found = allocate(&weights, &classes, limit).map_or(f64::INFINITY, |a| a.cost);
        possible.count(cheapest.is_finite());
        prop_assert!(found == cheapest || (found - cheapest).abs() < 1e-12);
    });
    possible.assert_accepted(0.7);
    possible.assert_refused(0.03);
}

#[test]
fn tension_lengthens_and_compression_shortens_by_the_sum_of_clearances() {
    let lengths = [0.1, 0.16, 0.16, 0.1, 0.08];
    let massless = arm(lengths, 0.0);
    let weightless = Arm::new(
        *massless.geometry(),
        *massless.links(),
        0.0,
        Vector2::zeros(),
        [1e-4; 2],
    )
    .unwrap();
    let mode = WorkingMode::new(Side::Right, Side::Left);
    let pose = massless
        .geometry()
        .inverse(Vector2::new(0.05, 0.2), mode)
        .unwrap();
    let [theta1, _, _, theta4] = pose.angles();
    let inputs = DrivenJointMotion {
        theta: [theta1, theta4],
        omega: [0.0; 2],
        alpha: [0.0; 2],
    };
    let radii = [10e-6, 20e-6, 5e-6, 15e-6, 10e-6];
    // Pulled away from the base both distal links are in tension, pushed in compression.
    for (force, sign) in [
        (Vector2::new(0.0, 10.0), 1.0),
        (Vector2::new(0.0, -10.0), -1.0),
    ] {
        let equilibrium =
            clearance_equilibrium(&weightless, pose.assembly(), &inputs, force, radii).unwrap();
        assert!(equilibrium.converged);
        let tool = pose.c + equilibrium.displacement;
        let longer2 = (tool - pose.b).length() - 0.16;
        let longer3 = (tool - pose.d).length() - 0.16;
        assert!((longer2 - sign * 30e-6).abs() < 1e-12, "{longer2:e}");
        assert!((longer3 - sign * 30e-6).abs() < 1e-12, "{longer3:e}");
    }
}
