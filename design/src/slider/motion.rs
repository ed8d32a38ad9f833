//! Velocities and accelerations, forward and inverse.
//!
//! Each limb keeps its length: with e = (1, 0), u·(ṙP − ẋ e) = 0 and
//! u·(r̈P − ẍ e) = −|ṙP − ẋ e|²/l, for (u3, x2, l3) and (u7, x8, l7). Forward these are
//! two linear equations with determinant S = sin(α7−α3). Inverse, with yẏ/h = tan α ẏ,
//! they are the equations of Tu 2005:
//!
//! ẋ2 = ẋP + yẏ/h3, ẍ2 = ẍP + yÿ/h3 + l3² ẏ²/h3³, and for x8 with −h7 for h3.

use super::{Geometry, Limb, Pose, PoseError};
use crate::linkage::dyad::is_regular;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The velocities of the sliders, P and the limbs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Velocities<S> {
    /// ẋ2 and ẋ8 [m/s].
    pub sliders: [S; 2],
    /// ṙP [m/s].
    pub p: Vector2<S>,
    /// α̇3 and α̇7 [rad/s].
    pub omega: [S; 2],
}

/// The accelerations of the sliders, P and the limbs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accelerations<S> {
    /// ẍ2 and ẍ8 [m/s²].
    pub sliders: [S; 2],
    /// r̈P [m/s²].
    pub p: Vector2<S>,
    /// α̈3 and α̈7 [rad/s²].
    pub alpha: [S; 2],
}

impl<S: Scalar> Geometry<S> {
    /// All velocities from the sliders' [m/s].
    ///
    /// # Errors
    /// `Parallel`.
    pub fn forward_velocities(
        &self,
        pose: &Pose<S>,
        sliders: [S; 2],
    ) -> Result<Velocities<S>, PoseError> {
        let [x2, x8] = sliders;
        let p = pose.solve(pose.u3.x * x2, pose.u7.x * x8)?;
        Ok(self.velocities(pose, sliders, p))
    }

    /// All accelerations from the sliders' [m/s²].
    ///
    /// # Errors
    /// `Parallel`.
    pub fn forward_accelerations(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        sliders: [S; 2],
    ) -> Result<Accelerations<S>, PoseError> {
        let [x2, x8] = sliders;
        let [pull3, pull7] = self.centripetal(velocities);
        let p = pose.solve(pose.u3.x * x2 - pull3, pose.u7.x * x8 - pull7)?;
        Ok(self.accelerations(pose, sliders, p))
    }

    /// All velocities from P's [m/s].
    ///
    /// # Errors
    /// `LimbPerpendicular`, with the limb.
    pub fn inverse_velocities(
        &self,
        pose: &Pose<S>,
        p: Vector2<S>,
    ) -> Result<Velocities<S>, PoseError> {
        let [c3, c7] = pose.cosines()?;
        let sliders = [pose.u3.dot(&p) / c3, pose.u7.dot(&p) / c7];
        Ok(self.velocities(pose, sliders, p))
    }

    /// All accelerations from P's [m/s²].
    ///
    /// # Errors
    /// `LimbPerpendicular`, with the limb.
    pub fn inverse_accelerations(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        p: Vector2<S>,
    ) -> Result<Accelerations<S>, PoseError> {
        let [c3, c7] = pose.cosines()?;
        let [pull3, pull7] = self.centripetal(velocities);
        let sliders = [
            (pose.u3.dot(&p) + pull3) / c3,
            (pose.u7.dot(&p) + pull7) / c7,
        ];
        Ok(self.accelerations(pose, sliders, p))
    }

    /// l ω² of each limb, the acceleration of its upper end towards its lower one.
    fn centripetal(&self, velocities: &Velocities<S>) -> [S; 2] {
        let [omega3, omega7] = velocities.omega;
        [self.l3() * omega3 * omega3, self.l7() * omega7 * omega7]
    }

    fn velocities(&self, pose: &Pose<S>, sliders: [S; 2], p: Vector2<S>) -> Velocities<S> {
        let omega = self.turning(pose, sliders, p);
        Velocities { sliders, p, omega }
    }

    fn accelerations(&self, pose: &Pose<S>, sliders: [S; 2], p: Vector2<S>) -> Accelerations<S> {
        let alpha = self.turning(pose, sliders, p);
        Accelerations { sliders, p, alpha }
    }

    /// The limbs' angular rates from P's velocity relative to each slider, or their angular
    /// accelerations from P's relative acceleration.
    fn turning(&self, pose: &Pose<S>, [x2, x8]: [S; 2], p: Vector2<S>) -> [S; 2] {
        let against = |x: S| p - Vector2::new(x, S::ZERO);
        [
            against(x2).dot(&pose.u3.perpendicular()) / self.l3(),
            against(x8).dot(&pose.u7.perpendicular()) / self.l7(),
        ]
    }
}

impl<S: Scalar> Pose<S> {
    /// The vector r with u3·r = `along3` and u7·r = `along7`.
    #[inline]
    pub(super) fn solve(&self, along3: S, along7: S) -> Result<Vector2<S>, PoseError> {
        let s = self.sin73();
        if !is_regular(s) {
            return Err(PoseError::Parallel);
        }
        let (u3, u7) = (self.u3, self.u7);
        Ok(Vector2::new(
            (u7.y * along3 - u3.y * along7) / s,
            (u3.x * along7 - u7.x * along3) / s,
        ))
    }

    /// cos α3 and cos α7 as divisors.
    fn cosines(&self) -> Result<[S; 2], PoseError> {
        for (u, limb) in [(self.u3, Limb::Left), (self.u7, Limb::Right)] {
            if !is_regular(u.x) {
                return Err(PoseError::LimbPerpendicular(limb));
            }
        }
        Ok([self.u3.x, self.u7.x])
    }
}
