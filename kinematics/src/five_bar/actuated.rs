//! The driven joints' part of the inverse solution, which is all that the tick needs.
//!
//! [`Tool::inverse`] and its velocities and accelerations in one pass. Leg 1 is the dyad
//! A–B–T: with b = AB, q = BT, X = b×q = l1 |BT| sin, v and a the tool's velocity and
//! acceleration (Yu 2007, its α1 over T in place of C, multiplied out):
//!
//! ω1 = v·q/X, ω2 = −v·b/X,
//! α1 = (a·q + ω1² b·q + ω2² |BT|²)/X, α2 = −(a·b + ω1² l1² + ω2² b·q)/X.
//!
//! C follows on link 2: rC = rT + w, ṙC = v + ω2 w⊥, r̈C = a + α2 w⊥ − ω2² w. Leg 4 alike
//! from there, driven from E.

use super::dyad::{Dyad, DyadSolution};
use super::inverse::{refusal1, refusal4};
use super::{PoseError, Tool, WorkingMode};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The motion of the driven joints; index 0 is joint 1, index 1 joint 4.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side, Tool, WorkingMode};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let tool = Tool::new(geometry, Vector2::zeros())?;
/// let outwards = WorkingMode::new(Side::Right, Side::Left);
///
/// // C on the arm's axis of symmetry [m], moving along it at 0.5 m/s.
/// let (t, v, a) = (Vector2::new(0.04, 0.20), Vector2::new(0.0, 0.5), Vector2::zeros());
/// let joints = tool.actuated_joints(t, v, a, outwards)?;
/// assert!(joints.omega[0] < -1.0); // rad/s, clockwise
/// assert!((joints.omega[0] + joints.omega[1]).abs() < 1e-12);
/// assert!((joints.alpha[0] + joints.alpha[1]).abs() < 1e-9);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatedJointState<S> {
    /// u(θ1), u(θ4).
    pub direction: [Vector2<S>; 2],
    /// ω1, ω4 [rad/s].
    pub omega: [S; 2],
    /// α1, α4 [rad/s²].
    pub alpha: [S; 2],
}

/// A leg whose end moves with a point.
struct Leg<S> {
    /// b, the driven link [m].
    driven: Vector2<S>,
    /// q, from its elbow to the point [m].
    distal: Vector2<S>,
    /// 1/X [1/m²].
    per_cross: S,
    /// Velocity of the driven link [rad/s].
    near_velocity: S,
    /// Velocity of the distal link [rad/s].
    far_velocity: S,
}

impl<S: Scalar> Leg<S> {
    /// The leg that ends in `point` [m], given from its pivot, which moves with `v` [m/s].
    #[inline(always)]
    fn new(closed: &DyadSolution<S>, point: Vector2<S>, v: Vector2<S>) -> Self {
        // b×p = b×q is −p×b.
        let (driven, per_cross) = (closed.joint, -S::ONE / closed.cross);
        let distal = point - driven;
        Self {
            driven,
            distal,
            per_cross,
            near_velocity: v.dot(&distal) * per_cross,
            far_velocity: -v.dot(&driven) * per_cross,
        }
    }

    /// The driven link's acceleration [rad/s²] where that of the point is `a` [m/s²].
    #[inline(always)]
    fn near_acceleration(&self, dyad: &Dyad<S>, a: Vector2<S>) -> S {
        (a.dot(&self.distal)
            + self.near_velocity * self.near_velocity * self.driven.dot(&self.distal)
            + self.far_velocity * self.far_velocity * dyad.far_squared())
            * self.per_cross
    }

    /// The distal link's acceleration [rad/s²] where that of the point is `a` [m/s²].
    #[inline(always)]
    fn far_acceleration(&self, dyad: &Dyad<S>, a: Vector2<S>) -> S {
        -(a.dot(&self.driven)
            + self.near_velocity * self.near_velocity * (dyad.near() * dyad.near())
            + self.far_velocity * self.far_velocity * self.driven.dot(&self.distal))
            * self.per_cross
    }
}

impl<S: Scalar> Tool<S> {
    /// The driven joints' part in a motion of the tool: at `t` [m], with velocity `v`
    /// [m/s] and acceleration `a` [m/s²], in a working mode.
    ///
    /// # Errors
    /// As [`Tool::inverse`] and [`Tool::inverse_velocities`].
    #[inline(always)]
    pub fn actuated_joints(
        &self,
        t: Vector2<S>,
        v: Vector2<S>,
        a: Vector2<S>,
        mode: WorkingMode,
    ) -> Result<ActuatedJointState<S>, PoseError> {
        let geometry = self.geometry();
        let [per_l1, _, _, per_l4] = geometry.per_length();

        let dyad = self.leg1();
        let closed = dyad.solve_precisely(t, mode.elbow1.opposite());
        let leg1 = Leg::new(&closed.map_err(refusal1)?, t, v);
        let alpha1 = leg1.near_acceleration(dyad, a);

        let (c, v, a) = match self.c_from_tool() {
            None => (t, v, a),
            Some(to_c) => {
                let w = to_c.to_base_frame(leg1.distal);
                let (omega2, alpha2) = (leg1.far_velocity, leg1.far_acceleration(dyad, a));
                (
                    t + w,
                    v + w.perpendicular() * omega2,
                    a + w.perpendicular() * alpha2 - w * (omega2 * omega2),
                )
            }
        };

        let dyad = geometry.leg4();
        let closed = dyad.solve_precisely_to(c, mode.elbow4.opposite());
        let leg4 = Leg::new(&closed.map_err(refusal4)?, c - geometry.e(), v);
        Ok(ActuatedJointState {
            direction: [leg1.driven * per_l1, leg4.driven * per_l4],
            omega: [leg1.near_velocity, leg4.near_velocity],
            alpha: [alpha1, leg4.near_acceleration(dyad, a)],
        })
    }
}
