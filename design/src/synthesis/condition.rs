//! How well an arm moves C at a point: 1/κ and the sines of its singularities, also beyond its reach.
//!
//! With p from a leg's pivot to C, q = |p|², near and far link n and f, the far link is the vector
//! v = c p − σ h p⊥, c = ½(1 − (n² − f²)/q), h = ½ √(((n + f)²/q − 1)(1 − (n − f)²/q)), σ = +1 where
//! the elbow lies left of p. The rows of J⁻¹ are v/(h q) of either leg. The sign of 1/κ is that of
//! v2 × v3 = l2 l3 sin(θ3 − θ2), so that it passes through 0 at a singularity of type 2.

use fivebar_kinematics::PlanarVector;
use nalgebra::Vector2;

/// Elbows out: B left of the ray A→C, D right of E→C, as `working_mode = ["right", "left"]` of robot
/// files.
pub(super) const ELBOWS_OUT: [f64; 2] = [1.0, -1.0];

/// An arm at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Condition {
    /// 1/κ with the sign of sin(θ3 − θ2).
    pub(super) dexterity: f64,
    /// sin(θ3 − θ2).
    pub(super) sine: f64,
    /// The lesser |sin| of both elbows.
    pub(super) elbow_sine: f64,
    /// The legs from A and from E.
    pub(super) legs: [Leg; 2],
}

/// A leg of an arm at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg {
    /// C from the leg's pivot, p.
    pub(super) foot: Vector2<f64>,
    /// The far link, v.
    pub(super) far: Vector2<f64>,
    /// h q, twice the area of the leg's triangle.
    height: f64,
}

impl Condition {
    /// The rows of J⁻¹.
    pub(super) fn inverse_jacobian(&self) -> [Vector2<f64>; 2] {
        self.legs.map(|leg| leg.far / leg.height)
    }
}

/// The condition of the arm with C at `c`, or how far `c` is beyond the reach of a leg, as a share of
/// that leg.
pub(super) fn condition(
    [l1, l2, l3, l4, base]: [f64; 5],
    c: Vector2<f64>,
) -> Result<Condition, f64> {
    let [side1, side4] = ELBOWS_OUT;
    let leg1 = leg([l1, l2], c, side1)?;
    let leg4 = leg([l4, l3], c - Vector2::new(base, 0.0), side4)?;
    let (row1, row4) = (leg1.far * leg4.height, leg4.far * leg1.height);
    let squares = row1.norm_squared() + row4.norm_squared();
    let det = row1.cross_z(row4);
    let sum = (squares + 2.0 * det.abs()).sqrt();
    let difference = (squares - 2.0 * det.abs()).max(0.0).sqrt();
    let inverse = (sum - difference) / (sum + difference);
    Ok(Condition {
        dexterity: inverse * det.signum(),
        sine: leg1.far.cross_z(leg4.far) / (l2 * l3),
        elbow_sine: (leg1.height / (l1 * l2)).min(leg4.height / (l4 * l3)),
        legs: [leg1, leg4],
    })
}

/// The leg whose links are near and far [m], with C at `p` from its pivot.
fn leg([near, far]: [f64; 2], p: Vector2<f64>, side: f64) -> Result<Leg, f64> {
    let q = p.norm_squared();
    let (sum, difference) = (near + far, near - far);
    let product = (sum * sum - q) * (q - difference * difference);
    if product <= 0.0 {
        let distance = q.sqrt();
        return Err((distance - sum).max(difference.abs() - distance).max(0.0) / sum);
    }
    let height = 0.5 * product.sqrt();
    let along = 0.5 * (1.0 - sum * difference / q);
    Ok(Leg {
        foot: p,
        far: p * along - p.perpendicular() * (side * height / q),
        height,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use fivebar_kinematics::five_bar::{Side, WorkingMode};
    use fivebar_testkit::{Tally, geometry};
    use proptest::prelude::*;

    #[test]
    fn it_is_that_of_the_kinematics() {
        let reached = Tally::default();
        let mode = WorkingMode::new(Side::Right, Side::Left);
        proptest!(|(geometry in geometry(), x in -0.5..0.5_f64, y in -0.5..0.5_f64)| {
            let c = Vector2::new(x, y);
            let found = condition(geometry.lengths(), c);
            let pose = geometry.inverse(c, mode);
            prop_assert_eq!(found.is_ok(), pose.is_ok());
            let (Ok(found), Ok(pose)) = (found, pose) else { return Ok(()) };
            prop_assume!(pose.nearest_singularity().1 > 1e-4);
            reached.count(true);
            let expected = geometry.jacobian(&pose).unwrap().inverse_condition();
            prop_assert!((found.dexterity.abs() - expected).abs() < 1e-9);
            prop_assert!((found.sine - pose.sin32()).abs() < 1e-9);
            prop_assert_eq!(found.dexterity > 0.0, pose.sin32() > 0.0);
            let elbow = pose.sin21().abs().min(pose.sin34().abs());
            prop_assert!((found.elbow_sine - elbow).abs() < 1e-9);
        });
        assert!(reached.accepted() > 50);
    }
}
