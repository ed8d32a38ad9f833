//! The regions by mode and the crossings between them, compared with forward kinematics and with
//! torques of the full dynamics.

use fivebar_design::crossing::CrossingCondition;
use fivebar_files::robot::Robot;
use fivebar_kinematics::five_bar::Side;
use fivebar_report::study::regions::{crossing_direction, regions};
use nalgebra::Vector2;

fn robot() -> Robot {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../host/files/robots/short_couplers.toml"
    );
    Robot::load(file).unwrap()
}

#[test]
fn each_place_is_in_the_region_whose_assembly_the_forward_solution_needs() {
    let robot = robot();
    let geometry = *robot.arm().unwrap().geometry();
    let all = regions(&robot).unwrap();
    assert_eq!(all.len(), 4);
    for of_mode in &all {
        for (side, places) in Side::BOTH.into_iter().zip(&of_mode.reached) {
            assert!(places.len() > 10);
            for place in places {
                let [theta1, _, _, theta4] =
                    geometry.inverse(*place, of_mode.mode).unwrap().angles();
                let found = geometry.forward(theta1, theta4, side).unwrap().c;
                assert!((found - place).norm() < 1e-9, "{place} is not {side}");
            }
        }
    }
}

#[test]
fn a_crossing_changes_the_assembly_and_needs_bounded_torque_only_with_its_acceleration() {
    let robot = robot();
    let arm = robot.arm().unwrap();
    let geometry = arm.geometry();
    let mut crossings = 0;
    for of_mode in regions(&robot).unwrap() {
        for c in of_mode.crossable.concat().iter().step_by(7) {
            let along = crossing_direction(&robot, arm, of_mode.mode, *c).unwrap();
            let pose = |s: f64| geometry.inverse(c + along * s, of_mode.mode);
            let (Ok(before), Ok(after)) = (pose(-1e-4), pose(1e-4)) else {
                continue;
            };
            assert_ne!(before.assembly(), after.assembly(), "{c}");
            // τ grows as f/sin(θ3−θ2), so it stays as it is only where f = 0.
            let here = pose(0.0).unwrap();
            let speed = 0.1;
            let moving = geometry.inverse_velocities(&here, along * speed).unwrap();
            let condition = CrossingCondition::new(arm, &here, &moving);
            let needed = -condition.f0 / condition.n.dot(&along);
            let torque = |s: f64, s_ddot: f64| {
                let pose = pose(s).unwrap();
                let moving = geometry.inverse_velocities(&pose, along * speed).unwrap();
                let all = geometry.inverse_accelerations(&pose, &moving, along * s_ddot);
                let torque = arm.inverse_dynamics(&pose, &moving, &all.unwrap(), Vector2::zeros());
                torque
                    .unwrap()
                    .map(f64::abs)
                    .into_iter()
                    .fold(0.0, f64::max)
            };
            let growth = |s_ddot: f64| torque(1e-7, s_ddot) / torque(1e-6, s_ddot);
            let (with, without) = (growth(needed), growth(needed + 5.0));
            assert!(with < 1.5 && without > 5.0, "{c}: {with}, {without}");
            crossings += 1;
        }
    }
    assert!(crossings > 30, "{crossings}");
}
