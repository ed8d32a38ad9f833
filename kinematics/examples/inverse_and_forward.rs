//! Positions both ways: from positions of C to the driven angles, and back.
//!
//! `cargo run --example inverse_and_forward`

use fivebar_kinematics::five_bar::{Geometry, PoseError, Side, Unreachable, WorkingMode};
use fivebar_kinematics::nalgebra::Vector2;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    // Links 1 to 4 and the base A–E [m].
    let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
    // Both elbows outwards: seen along each leg, elbow B turns right and elbow D left.
    let outwards = WorkingMode::new(Side::Right, Side::Left);

    println!("     C [mm]          θ1 [°]   θ4 [°]  back to C within");
    let mut worst = 0.0_f64;
    for y in [0.16, 0.19, 0.22] {
        for x in [0.00, 0.04, 0.08] {
            let c = Vector2::new(x, y);
            let pose = geometry.inverse(c, outwards)?;
            let [theta1, _, _, theta4] = pose.angles();

            // The angles alone allow two positions of C. The assembly mode selects one.
            let forward = geometry.forward(theta1, theta4, pose.assembly())?;
            let error = (forward.c - c).norm();
            worst = worst.max(error);
            println!(
                "({:6.1}, {:6.1})   {:8.2} {:8.2}   {error:.1e} m",
                1e3 * x,
                1e3 * y,
                theta1.to_degrees(),
                theta4.to_degrees(),
            );
        }
    }
    assert!(worst < 1e-15, "the two solutions differ by {worst} m");

    // A point out of reach is an error that names the leg.
    let refused = geometry.inverse(Vector2::new(0.30, 0.0), outwards);
    let expected = PoseError::Unreachable(Unreachable::Leg1TooFar);
    assert_eq!(refused, Err(expected));
    println!("(300.0, 0.0): {expected}");
    Ok(())
}

#[test]
fn every_point_is_found_again() -> Result<(), Box<dyn Error>> {
    main()
}
