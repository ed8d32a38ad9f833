//! Arms and paths of the tests.

use fivebar_design::time_optimal::{DrivenArm, PathPiece, PlanLimits, PlannedDrive};
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Side, Tool, WorkingMode};
use nalgebra::Vector2;
use proptest::prelude::*;

pub(crate) const OUTWARDS: WorkingMode = WorkingMode::new(Side::Right, Side::Left);

/// An arm near the benchtop arm: lengths and masses differ from it by these factors.
pub(crate) fn arm(lengths: [f64; 5], masses: [f64; 4], gravity: [f64; 2]) -> Arm<f64> {
    let nominal = [0.10, 0.16, 0.16, 0.10, 0.08];
    let lengths: [f64; 5] = std::array::from_fn(|k| nominal[k] * lengths[k]);
    let links = std::array::from_fn(|k| {
        let mass = 0.06 * masses[k];
        Link {
            com: Vector2::new(0.45 * lengths[k], 0.002),
            ..Link::uniform_rod(mass, lengths[k])
        }
    });
    let geometry = Geometry::new(lengths).unwrap();
    Arm::new(geometry, links, 0.03, Vector2::from(gravity), [6e-5; 2]).unwrap()
}

pub(crate) fn driven(arm: &Arm<f64>, friction: [f64; 2]) -> DrivenArm {
    let tool = Tool::new(*arm.geometry(), Vector2::zeros()).unwrap();
    let [viscous, coulomb] = friction;
    let drive = PlannedDrive {
        viscous,
        coulomb,
        torque_constant: 0.187,
        resistance: 2.3,
    };
    DrivenArm::new(arm, tool, OUTWARDS, [drive; 2]).unwrap()
}

/// Limits of torque only.
pub(crate) fn torque_limits(torque: f64) -> PlanLimits {
    PlanLimits {
        torque: [torque; 2],
        falling_torque: None,
        speed: [f64::INFINITY; 2],
        acceleration: [f64::INFINITY; 2],
        voltage: None,
        tip_speed: None,
        tip_acceleration: None,
    }
}

pub(crate) fn factors<const N: usize>() -> impl Strategy<Value = [f64; N]> {
    [(); N].map(|()| 0.9..1.1_f64)
}

/// A point in front of the arm.
pub(crate) fn point() -> impl Strategy<Value = Vector2<f64>> {
    (-0.03..0.11, 0.12..0.2).prop_map(|(x, y)| Vector2::new(x, y))
}

pub(crate) fn line(from: Vector2<f64>, to: Vector2<f64>) -> [PathPiece; 1] {
    [PathPiece::Line { from, to }]
}
