//! What the tick needs of the inverse solution and no more: the driven joints.
//!
//! [`Tool::inverse`] and its velocities and accelerations in one pass. With t the unit
//! vector from B to the tool T, p1 = 1/(l1 u1×t), pT = 1/(|BT| u1×t), v and a the tool's
//! velocity and acceleration (Yu 2007, its α1 over T in place of C):
//!
//! ω1 = v·t p1, ω2 = −v·u1 pT,
//! α1 = (a·t + l1 ω1² u1·t + |BT| ω2²) p1, α2 = −(a·u1 + l1 ω1² + |BT| ω2² u1·t) pT.
//!
//! C follows on link 2: rC = rT + w, ṙC = v + ω2 w⊥, r̈C = a + α2 w⊥ − ω2² w. Leg 4 alike
//! from there, driven from E.

use super::circles::intersect;
use super::inverse::{refusal1, refusal4};
use super::motion::per_sine;
use super::{PoseError, Singularity, Tool, WorkingMode};
use crate::{Scalar, Vec2};

/// The motion of the driven joints; index 0 is joint 1, index 1 joint 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driven<S> {
    /// u(θ1), u(θ4).
    pub direction: [Vec2<S>; 2],
    /// ω1, ω4 [rad/s].
    pub omega: [S; 2],
    /// α1, α4 [rad/s²].
    pub alpha: [S; 2],
}

/// A leg that reaches a given point: driven link near its base, distal link to the point.
struct Leg<S> {
    /// Unit vectors of the driven and of the distal link.
    driven: Vec2<S>,
    distal: Vec2<S>,
    /// Lengths of both [m].
    near: S,
    far: S,
    /// 1/(length · sine of the angle between the links), the sine from the driven link to
    /// the distal one [1/m].
    per_near: S,
    per_far: S,
}

impl<S: Scalar> Leg<S> {
    /// `elbow` is the elbow relative to the base, `point` what is reached [m].
    #[inline(always)]
    fn new(
        elbow: Vec2<S>,
        point: Vec2<S>,
        [near, far]: [S; 2],
        [per_near, per_far]: [S; 2],
        singularity: Singularity,
    ) -> Result<Self, PoseError> {
        let driven = elbow * per_near;
        let distal = (point - elbow) * per_far;
        let per_sin = per_sine(driven.cross(distal), singularity)?;
        Ok(Self {
            driven,
            distal,
            near,
            far,
            per_near: per_near * per_sin,
            per_far: per_far * per_sin,
        })
    }

    /// The driven link's velocity.
    #[inline(always)]
    fn near_velocity(&self, v: Vec2<S>) -> S {
        v.dot(self.distal) * self.per_near
    }

    /// The distal link's velocity.
    #[inline(always)]
    fn far_velocity(&self, v: Vec2<S>) -> S {
        -v.dot(self.driven) * self.per_far
    }

    /// The driven link's acceleration.
    #[inline(always)]
    fn near_acceleration(&self, a: Vec2<S>, near_velocity: S, far_velocity: S) -> S {
        (a.dot(self.distal)
            + self.near * near_velocity * near_velocity * self.driven.dot(self.distal)
            + self.far * far_velocity * far_velocity)
            * self.per_near
    }

    /// The distal link's acceleration.
    #[inline(always)]
    fn far_acceleration(&self, a: Vec2<S>, near_velocity: S, far_velocity: S) -> S {
        -(a.dot(self.driven)
            + self.near * near_velocity * near_velocity
            + self.far * far_velocity * far_velocity * self.driven.dot(self.distal))
            * self.per_far
    }
}

impl<S: Scalar> Tool<S> {
    /// The driven joints' part in a motion of the tool: at `t` [m], with velocity `v`
    /// [m/s] and acceleration `a` [m/s²], in a working mode.
    ///
    /// # Errors
    /// As [`Tool::inverse`] and [`Tool::inverse_velocities`].
    #[inline(always)]
    pub fn driven(
        &self,
        t: Vec2<S>,
        v: Vec2<S>,
        a: Vec2<S>,
        mode: WorkingMode,
    ) -> Result<Driven<S>, PoseError> {
        let geometry = self.geometry();
        let [per_l1, _, per_l3, per_l4] = geometry.per_length();
        let (l1, l3, l4) = (geometry.l1(), geometry.l3(), geometry.l4());

        let ab = intersect(t, l1, self.reach(), mode.elbow1.opposite()).map_err(refusal1)?;
        let lengths = ([l1, self.reach()], [per_l1, self.per_reach()]);
        let leg1 = Leg::new(ab, t, lengths.0, lengths.1, Singularity::Leg1)?;
        let omega1 = leg1.near_velocity(v);
        let omega2 = leg1.far_velocity(v);
        let alpha1 = leg1.near_acceleration(a, omega1, omega2);

        let (c, v, a) = match self.c_from_tool() {
            None => (t, v, a),
            Some(to_c) => {
                let w = to_c.rotated_to(leg1.distal);
                let alpha2 = leg1.far_acceleration(a, omega1, omega2);
                (
                    t + w,
                    v + w.perp() * omega2,
                    a + w.perp() * alpha2 - w * (omega2 * omega2),
                )
            }
        };

        let ec = c - geometry.e();
        let ed = intersect(ec, l4, l3, mode.elbow4.opposite()).map_err(refusal4)?;
        let leg4 = Leg::new(ed, ec, [l4, l3], [per_l4, per_l3], Singularity::Leg4)?;
        let omega4 = leg4.near_velocity(v);
        let omega3 = leg4.far_velocity(v);
        Ok(Driven {
            direction: [leg1.driven, leg4.driven],
            omega: [omega1, omega4],
            alpha: [alpha1, leg4.near_acceleration(a, omega4, omega3)],
        })
    }
}
