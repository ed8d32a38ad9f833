//! Changes of the working mode through a stretched leg: states and torques along a quintic of the
//! driven angles.

use fivebar_files::robot::Robot;
use fivebar_kinematics::five_bar::Side;
use nalgebra::Vector2;
use serde_json::Value;

fn numbers<const N: usize>(values: &Value) -> [f64; N] {
    std::array::from_fn(|k| values[k].as_f64().unwrap())
}

#[test]
fn states_and_torques_are_regular_through_type_1() {
    let all: Value = serde_json::from_str(include_str!("../../data/type1.json")).unwrap();
    let robot = Robot::load(all["robot"].as_str().unwrap()).unwrap();
    let (arm, motors) = (robot.arm().unwrap(), robot.actuators.unwrap());
    let mut compared = 0;
    for case in all["cases"].as_array().unwrap() {
        for sample in case["samples"].as_array().unwrap() {
            let theta: [f64; 4] = numbers(&sample["theta"]);
            let omega: [f64; 4] = numbers(&sample["omega"]);
            let alpha: [f64; 4] = numbers(&sample["alpha"]);
            let geometry = arm.geometry();
            let pose = geometry.forward(theta[0], theta[3], Side::Left).unwrap();
            let velocities = geometry
                .forward_velocities(&pose, omega[0], omega[3])
                .unwrap();
            let accelerations = geometry
                .forward_accelerations(&pose, &velocities, alpha[0], alpha[3])
                .unwrap();
            let torque = arm
                .inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros())
                .unwrap();
            let c: [f64; 2] = numbers(&sample["c"]);
            assert!((pose.c - Vector2::from(c)).norm() < 1e-9);
            for k in 0..4 {
                assert!((velocities.omega[k] - omega[k]).abs() < 1e-9 * (1.0 + omega[k].abs()));
                assert!((accelerations.alpha[k] - alpha[k]).abs() < 1e-9 * (1.0 + alpha[k].abs()));
            }
            let expected: [f64; 2] = numbers(&sample["torque"]);
            for (j, speed) in [omega[0], omega[3]].into_iter().enumerate() {
                let motor = &motors[j];
                let sign = (speed / 0.1).tanh();
                let friction = motor.viscous_friction * speed + motor.coulomb_friction * sign;
                assert!((torque[j] + friction - expected[j]).abs() < 1e-9);
            }
            compared += 1;
        }
    }
    assert_eq!(compared, 42);
}
