//! The eight branches of a five-bar: four working modes for a position of C, two
//! assembly modes for a pair of driven angles.
//!
//! `cargo run --example all_branches`

use fivebar_kinematics::five_bar::{Geometry, Pose, Side, WorkingMode};
use fivebar_kinematics::nalgebra::Vector2;
use std::error::Error;

fn describe(pose: &Pose<f64>) -> String {
    let WorkingMode { elbow1, elbow4 } = pose.working_mode();
    let [theta1, _, _, theta4] = pose.angles().map(f64::to_degrees);
    let assembly = pose.assembly();
    let (singularity, sine) = pose.nearest_singularity();
    format!(
        "elbows {elbow1:>5}, {elbow4:>5}  assembly {assembly:>5}  θ1 {theta1:7.1}°  θ4 {theta4:7.1}°  \
         C ({:6.1}, {:6.1}) mm  least sine {sine:.2}: {singularity}",
        1e3 * pose.c.x,
        1e3 * pose.c.y,
    )
}

fn main() -> Result<(), Box<dyn Error>> {
    let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
    let c = Vector2::new(0.05, 0.14);

    println!("the four working modes for C at (50, 140) mm");
    let mut poses = Vec::new();
    for mode in WorkingMode::ALL {
        let pose = geometry.inverse(c, mode)?;
        println!("{}", describe(&pose));
        assert_eq!(pose.working_mode(), mode);
        poses.push(pose);
    }

    println!("the same driven angles in the other assembly mode");
    for pose in poses.clone() {
        let other =
            geometry.forward_from_directions(pose.u1, pose.u4, pose.assembly().opposite())?;
        println!("{}", describe(&other));
        assert!((other.c - c).norm() > 1e-3, "C must be elsewhere");
        // B and D are where they were: C is its own mirror image in the line through both.
        assert!((other.b - pose.b).norm() < 1e-15);
        poses.push(other);
    }

    // All eight are different, and every one closes: |BC| = l2, |DC| = l3.
    for (index, pose) in poses.iter().enumerate() {
        assert!(((pose.c - pose.b).norm() - geometry.l2()).abs() < 1e-12);
        assert!(((pose.c - pose.d).norm() - geometry.l3()).abs() < 1e-12);
        for other in &poses[..index] {
            let distance = (pose.b - other.b).norm() + (pose.d - other.d).norm();
            assert!(distance + (pose.c - other.c).norm() > 1e-3);
        }
    }
    let left = poses.iter().filter(|pose| pose.assembly() == Side::Left);
    assert_eq!((poses.len(), left.count()), (8, 4));
    Ok(())
}

#[test]
fn there_are_eight_branches() -> Result<(), Box<dyn Error>> {
    main()
}
