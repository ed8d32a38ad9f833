//! The tip on the plate and its derivatives.

use super::parameters::Parameters;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Geometry, Pose, Side};
use nalgebra::{Rotation2, SMatrix, Vector2};

/// The tip on the plate, with its derivatives by l1…l5, δ1, δ4, x, y, φ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tip {
    /// T = R(φ) C + (x, y) [m].
    pub position: Vector2<f64>,
    /// ∂T/∂p.
    pub jacobian: SMatrix<f64, 2, 10>,
}

/// The tip of an arm whose encoders show these angles [rad]; none where it has no pose.
///
/// Both couplers keep their lengths, which gives for a change of C
///
/// u2·δC = u2·u1 δl1 + l1 (u2·n1) δδ1 + δl2 = g2,
/// u3·δC = u3·u4 δl4 + l4 (u3·n4) δδ4 + u3·x̂ δl5 + δl3 = g3,
/// δC = [u3y g2 − u2y g3; −u3x g2 + u2x g3] / (u2×u3),
/// δT = R δC + (δx, δy) + δφ (R C)⊥.
pub fn tip(p: &Parameters, encoder: [f64; 2], assembly: Side) -> Option<Tip> {
    Some(on_plate(p, &posed(p, encoder, assembly)?))
}

/// The pose of the arm [`tip`] speaks of.
pub(super) fn posed(p: &Parameters, encoder: [f64; 2], assembly: Side) -> Option<Pose<f64>> {
    let geometry = Geometry::new(p.lengths).ok()?;
    let [theta1, theta4] = [encoder[0] + p.offsets[0], encoder[1] + p.offsets[1]];
    let pose = geometry.forward(theta1, theta4, assembly).ok()?;
    (pose.sin32().abs() > 1e-9).then_some(pose)
}

/// The tip in this pose, whose lengths and placement are those of `p`.
pub(super) fn on_plate(p: &Parameters, pose: &Pose<f64>) -> Tip {
    let [l1, _, _, l4, _] = p.lengths;
    let (u1, u2, u3, u4) = (pose.u1, pose.u2, pose.u3, pose.u4);
    let (n1, n4) = (u1.perpendicular(), u4.perpendicular());
    let g2 = [u2.dot(&u1), 1.0, 0.0, 0.0, 0.0, l1 * u2.dot(&n1), 0.0];
    let g3 = [0.0, 0.0, 1.0, u3.dot(&u4), u3.x, 0.0, l4 * u3.dot(&n4)];
    let per_cross = 1.0 / pose.sin32();
    let turn = Rotation2::new(p.turn);
    let mut jacobian = SMatrix::<f64, 2, 10>::zeros();
    for (column, (g2, g3)) in g2.into_iter().zip(g3).enumerate() {
        let delta_c = Vector2::new(u3.y * g2 - u2.y * g3, u2.x * g3 - u3.x * g2) * per_cross;
        jacobian.set_column(column, &(turn * delta_c));
    }
    let turned = turn * pose.c;
    jacobian.set_column(7, &Vector2::x());
    jacobian.set_column(8, &Vector2::y());
    jacobian.set_column(9, &turned.perpendicular());
    Tip {
        position: turned + Vector2::from(p.origin),
        jacobian,
    }
}
