//! Statics of a five-bar leg: the torques that hold a force on the foot, τ = −Jᵀ F.
//!
//! Such legs carry walking robots: both motors sit at the hip, C is the foot. The x axis
//! points forwards along the hip, so that the foot is on the side of negative y.
//!
//! `cargo run --example torque_from_tip_force`

use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
use fivebar_kinematics::nalgebra::Vector2;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    // Thighs of 90 mm, shanks of 160 mm, motors 40 mm apart.
    let geometry = Geometry::new([0.09_f64, 0.16, 0.16, 0.09, 0.04])?;
    // Knees outwards; below the hip they turn the other way than above it.
    let knees_out = WorkingMode::new(Side::Left, Side::Right);
    // The ground pushes the foot up with 20 N and back with 3 N.
    let ground = Vector2::new(-3.0, 20.0);

    println!("foot below hip [mm]   τ1 [N·m]   τ4 [N·m]   1/κ");
    let mut torques = Vec::new();
    for below in [0.14, 0.16, 0.18, 0.20, 0.22, 0.24] {
        let foot = Vector2::new(0.02, -below);
        let pose = geometry.inverse(foot, knees_out)?;
        let jacobian = geometry.jacobian(&pose)?;
        // Jᵀ F turns the driven links; the motors hold against it.
        let torque = jacobian.torques(ground).map(|torque| -torque);
        println!(
            "{:18.0} {:11.3} {:10.3} {:7.2}",
            1e3 * below,
            torque[0],
            torque[1],
            jacobian.inverse_condition(),
        );

        // Virtual work: turning joint 1 by 1 µrad moves the foot against F.
        let [theta1, _, _, theta4] = pose.angles();
        let turned = geometry.forward(theta1 + 1e-6, theta4, pose.assembly())?;
        let work = ground.dot(&(turned.c - pose.c));
        assert!((torque[0] * 1e-6 + work).abs() < 1e-10);
        // A processor without a floating-point unit takes the angles, the rates and the torques together.
        let motors = geometry.drive_foot(foot, Vector2::zeros(), ground, knees_out)?;
        for (in_one_pass, torque) in motors.torque.iter().zip(torque) {
            assert!((in_one_pass - torque).abs() < 1e-12);
        }
        torques.push(torque);
    }
    // The torques vanish as the leg becomes straight: then the links alone carry the weight.
    let size = |torque: &[f64; 2]| torque[0].hypot(torque[1]);
    let straightening = torques[2..].windows(2);
    for pair in straightening {
        assert!(size(&pair[1]) < size(&pair[0]));
    }

    // The whole model of the leg at rest says the same, beyond the weight of its own links.
    let rods = [0.09, 0.16, 0.16, 0.09].map(|length| Link::uniform_rod(0.05, length));
    let leg = Arm::new(geometry, rods, 0.0, Vector2::new(0.0, -9.81), [1e-5; 2])?;
    let pose = geometry.inverse(Vector2::new(0.02, -0.18), knees_out)?;
    let rest = geometry.forward_velocities(&pose, 0.0, 0.0)?;
    let on_ground = leg.nonlinear_effects(&pose, &rest, ground)?;
    let in_the_air = leg.gravity_torque(&pose)?;
    for joint in 0..2 {
        let difference = on_ground[joint] - in_the_air[joint];
        assert!((difference - torques[2][joint]).abs() < 1e-12);
    }
    Ok(())
}

#[test]
fn torques_balance_the_force_on_the_foot() -> Result<(), Box<dyn Error>> {
    main()
}
