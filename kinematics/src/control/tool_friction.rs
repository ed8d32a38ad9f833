//! Friction of a tool that slides, such as a pen on paper, fed forward: τ = Jᵀ F v/√(v² + vs²).
//!
//! With r1 = AB, r2 = BC, r3 = DC, r4 = ED and X = r2 × r3 ([`Links`]), and t = BT = a r2 + b r2⊥ to the tool at T,
//!
//! ω2 = ω21 ω1 + ω24 ω4, ω21 = r3×r1/X, ω24 = −r3×r4/X,
//! v = J1 ω1 + J4 ω4, J1 = r1⊥ + ω21 t⊥, J4 = ω24 t⊥.
//!
//! It follows the desired velocities, which have no noise. Near rest it is F v/vs, so that it does not change its sign at once.

use crate::five_bar::{Links, Tool};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The controller's model of the friction of a tool.
///
/// ```
/// use fivebar_kinematics::PlanarVector;
/// use fivebar_kinematics::control::ToolFriction;
/// use fivebar_kinematics::five_bar::{Geometry, Side, Tool};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let tool = Tool::new(geometry, Vector2::zeros())?;
/// // 0.25 N, smoothed below 1 µm/s.
/// let friction = ToolFriction::new(&tool, 0.25, 1e-6);
/// let links = geometry.links(Vector2::<f64>::unit(2.0), Vector2::unit(1.1), Side::Left)?;
/// let [torque1, torque4] = friction.torque(&links, [3.0, -1.0]);
/// // Its power is what 0.25 N take from the speed of the tool.
/// let pose = geometry.pose(&links);
/// let speed = geometry.forward_velocities(&pose, 3.0, -1.0)?.c.norm();
/// assert!((3.0 * torque1 - torque4 - 0.25 * speed).abs() < 1e-6);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolFriction<S> {
    /// F [N].
    force: S,
    /// vs² [m²/s²].
    slow_squared: S,
    /// a, b.
    tool: [S; 2],
}

impl<S: Scalar> ToolFriction<S> {
    /// Of a tool that is held back by `force` F [N], with its sign smoothed over `slow` vs > 0 [m/s].
    pub fn new(tool: &Tool<S>, force: S, slow: S) -> Self {
        let (offset, length) = (tool.offset(), tool.geometry().l2());
        Self {
            force,
            slow_squared: slow * slow,
            tool: [S::ONE + offset.x / length, offset.y / length],
        }
    }

    /// The torques [N·m] that overcome it where the links are, at these velocities of the driven joints [rad/s].
    #[inline(always)]
    pub fn torque(&self, links: &Links<S>, [omega1, omega4]: [S; 2]) -> [S; 2] {
        let Links {
            ab: r1,
            bc: r2,
            dc: r3,
            ed: r4,
            cross,
        } = *links;
        let per_cross = S::ONE / cross;
        let omega21 = r3.cross_z(r1) * per_cross;
        let omega24 = -r3.cross_z(r4) * per_cross;
        let [along, left] = self.tool;
        // t⊥.
        let across = Vector2::new(-along * r2.y - left * r2.x, along * r2.x - left * r2.y);
        let by1 = Vector2::new(omega21 * across.x - r1.y, omega21 * across.y + r1.x);
        let by4 = Vector2::new(omega24 * across.x, omega24 * across.y);
        let velocity = Vector2::new(
            by1.x * omega1 + by4.x * omega4,
            by1.y * omega1 + by4.y * omega4,
        );
        let speed = (velocity.x * velocity.x + velocity.y * velocity.y + self.slow_squared).sqrt();
        let per_speed = self.force / speed;
        [
            per_speed * (by1.x * velocity.x + by1.y * velocity.y),
            per_speed * (by4.x * velocity.x + by4.y * velocity.y),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::five_bar::{Geometry, Side};
    use proptest::prelude::*;

    const SLOW: f64 = 5e-3;

    proptest! {
        /// The tool's velocity by differences of its place, and the force against it by the principle of virtual work.
        #[test]
        fn the_torques_do_the_work_of_the_force_along_the_tools_motion(
            theta in (1.7..2.6_f64, 0.5..1.4_f64), omega in (-9.0..9.0_f64, -9.0..9.0_f64),
            offset in (-0.03..0.03_f64, -0.03..0.03_f64), force in 0.05..1.0_f64,
        ) {
            let geometry = Geometry::new([0.10, 0.16, 0.16, 0.10, 0.08]).unwrap();
            let tool = Tool::new(geometry, Vector2::new(offset.0, offset.1)).unwrap();
            let friction = ToolFriction::new(&tool, force, SLOW);
            let at = |theta1: f64, theta4: f64| {
                tool.point(&geometry.forward(theta1, theta4, Side::Left).unwrap())
            };
            let h = 1e-6;
            let by1 = (at(theta.0 + h, theta.1) - at(theta.0 - h, theta.1)) / (2.0 * h);
            let by4 = (at(theta.0, theta.1 + h) - at(theta.0, theta.1 - h)) / (2.0 * h);
            let velocity = by1 * omega.0 + by4 * omega.1;
            let push = velocity * (force / velocity.norm().hypot(SLOW));
            let (u1, u4) = (Vector2::unit(theta.0), Vector2::unit(theta.1));
            let links = geometry.links(u1, u4, Side::Left).unwrap();
            let [torque1, torque4] = friction.torque(&links, [omega.0, omega.1]);
            prop_assert!((torque1 - by1.dot(&push)).abs() < 1e-7, "{torque1}");
            prop_assert!((torque4 - by4.dot(&push)).abs() < 1e-7, "{torque4}");
        }
    }

    #[test]
    fn at_rest_there_is_none_and_a_reversal_has_no_step() {
        let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08]).unwrap();
        let tool = Tool::new(geometry, Vector2::zeros()).unwrap();
        let friction = ToolFriction::new(&tool, 0.25, SLOW);
        let links = geometry
            .links(Vector2::unit(2.0), Vector2::unit(1.1), Side::Left)
            .unwrap();
        assert_eq!(friction.torque(&links, [0.0; 2]), [0.0; 2]);
        let [before, after] = [-1e-4, 1e-4].map(|omega| friction.torque(&links, [omega, 0.0]));
        assert_eq!(before, after.map(|torque| -torque));
        assert!(after[0].abs() < 2e-4, "{after:?}");
    }
}
