//! Identification: the reference regressors, Kane's equations, ranks.

use fivebar_design::Noise;
use fivebar_design::identification::{BASE_NAMES, Regressor, base_parameters, standard_parameters};
use fivebar_files::robot::Robot;
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{Geometry, Side};
use nalgebra::{DMatrix, Vector2};
use serde_json::Value;

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    let items = value.as_array().unwrap();
    items.iter().map(|item| item.as_f64().unwrap()).collect()
}

fn pair(value: &Value, first: usize, second: usize) -> [f64; 2] {
    let numbers = numbers(value);
    [numbers[first], numbers[second]]
}

#[test]
fn the_regressor_and_the_base_parameters_are_those_of_the_reference() {
    let text = include_str!("../../data/base_parameters.json");
    let reference: Value = serde_json::from_str(text).unwrap();
    let mut states = 0;
    for case in reference["cases"].as_array().unwrap() {
        let lengths: [f64; 5] = numbers(&case["link_lengths"]).try_into().unwrap();
        let geometry = Geometry::new(lengths).unwrap();
        let gravity = Vector2::from(pair(&case["gravity"], 0, 1));
        let links = case["standard"]
            .as_array()
            .unwrap()
            .iter()
            .flat_map(numbers);
        let standard: [f64; 16] = links.collect::<Vec<_>>().try_into().unwrap();
        let base = numbers(&case["base"]);
        let own = base_parameters(lengths, &standard);
        for (index, (own, wanted)) in own.iter().zip(&base).enumerate() {
            assert!((own - wanted).abs() < 1e-14, "{}", BASE_NAMES[index]);
        }
        for state in case["states"].as_array().unwrap() {
            let [q, omega, alpha] = ["theta", "omega", "alpha"].map(|key| pair(&state[key], 0, 3));
            let theta = numbers(&state["theta"]);
            let side = Side::BOTH.into_iter().find(|side| {
                let pose = geometry.forward(q[0], q[1], *side);
                pose.is_ok_and(|pose| {
                    (pose.angles()[1] - theta[1]).sin().abs() < 1e-9
                        && (pose.angles()[1] - theta[1]).cos() > 0.0
                })
            });
            let at = Regressor::at(&geometry, side.unwrap(), gravity, [q, omega, alpha]).unwrap();
            for joint in 0..2 {
                let rows = numbers(&state["base_rows"][joint]);
                for (index, wanted) in rows.iter().enumerate() {
                    let error = (at.base(index)[joint] - wanted).abs();
                    assert!(error <= 1e-10 * wanted.abs().max(1.0), "{index}: {error:e}");
                }
                let wanted = numbers(&state["torque"])[joint];
                let whole = at
                    .standard
                    .row(joint)
                    .transpose()
                    .dot(&nalgebra::SVector::from(standard));
                assert!((at.torque(&base)[joint] - wanted).abs() < 1e-10);
                assert!((whole - wanted).abs() < 1e-10);
            }
            states += 1;
        }
    }
    assert_eq!(states, 36);
}

#[test]
fn kanes_equations_give_the_torques_of_the_base_parameters() {
    let robot = Robot::load("air_hockey").unwrap();
    for gravity in [Vector2::zeros(), Vector2::new(0.3, -9.81)] {
        let own = robot.arm().unwrap();
        let arm = Arm::new(
            robot.geometry,
            *own.links(),
            own.payload(),
            gravity,
            own.rotor_inertia(),
        );
        let arm = arm.unwrap();
        let base = base_parameters(robot.geometry.lengths(), &standard_parameters(&arm));
        let used = if gravity == Vector2::zeros() { 7 } else { 11 };
        let home = robot.home_pose().unwrap();
        let [q1, _, _, q4] = home.angles();
        let (omega, alpha) = ([3.0, -2.0], [40.0, 25.0]);
        let at = Regressor::at(
            &robot.geometry,
            home.assembly(),
            gravity,
            [[q1, q4], omega, alpha],
        );
        let velocities = robot
            .geometry
            .forward_velocities(&home, omega[0], omega[1])
            .unwrap();
        let accelerations = robot
            .geometry
            .forward_accelerations(&home, &velocities, alpha[0], alpha[1])
            .unwrap();
        let kane = arm
            .inverse_dynamics(&home, &velocities, &accelerations, Vector2::zeros())
            .unwrap();
        let own = at.unwrap().torque(&base[..used]);
        for joint in 0..2 {
            assert!(
                (own[joint] / kane[joint] - 1.0).abs() < 1e-11,
                "{own:?} {kane:?}"
            );
        }
    }
}

/// The rank of a matrix with columns of one size.
fn rank(mut matrix: DMatrix<f64>) -> usize {
    for mut column in matrix.column_iter_mut() {
        let size = column.norm();
        column /= size.max(1e-300);
    }
    let values = matrix.singular_values();
    values
        .iter()
        .filter(|&&value| value > 1e-9 * values[0])
        .count()
}

#[test]
fn seven_parameters_are_seen_on_a_level_arm_and_eleven_with_gravity() {
    let mut noise = Noise::new(1);
    for lengths in [
        [0.10, 0.16, 0.16, 0.10, 0.08],
        [0.09, 0.10, 0.11, 0.085, 0.118],
    ] {
        let geometry = Geometry::new(lengths).unwrap();
        for (gravity, wanted) in [(Vector2::zeros(), 7), (Vector2::new(1.0, -9.0), 11)] {
            let mut rows = DMatrix::zeros(1200, 16);
            let mut friction = DMatrix::zeros(1200, wanted + 6);
            let mut found = 0;
            while found < 600 {
                let mut two = |size: f64| [size * noise.normal(), size * noise.normal()];
                let motion = [two(2.0), two(5.0), two(80.0)];
                let at = Regressor::at(&geometry, Side::Left, gravity, motion);
                let Some(at) = at.ok().filter(|at| at.pose.sin32().abs() > 0.3) else {
                    continue;
                };
                for joint in 0..2 {
                    let row = 2 * found + joint;
                    rows.set_row(row, &at.standard.row(joint));
                    for index in 0..wanted {
                        friction[(row, index)] = at.base(index)[joint];
                    }
                    friction[(row, wanted + joint)] = motion[1][joint];
                    friction[(row, wanted + 2 + joint)] = motion[1][joint].signum();
                    friction[(row, wanted + 4 + joint)] = 1.0;
                }
                found += 1;
            }
            // Columns without gravity that are zero have no rank.
            assert_eq!(rank(rows), wanted);
            assert_eq!(rank(friction), wanted + 6);
        }
    }
}
