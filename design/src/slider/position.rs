//! Positions, forward and inverse.

use super::{Geometry, Limb, PoseError};
use crate::linkage::dyad::SlideBranch;
use fivebar_kinematics::five_bar::Side;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The branch of the inverse solution: for each slider whether it is behind or ahead of its
/// end of the platform.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct WorkingMode {
    /// `Behind` where cos α3 > 0.
    pub left: SlideBranch,
    /// `Behind` where cos α7 > 0.
    pub right: SlideBranch,
}

impl WorkingMode {
    /// All four.
    pub const ALL: [Self; 4] = [
        Self::APART,
        Self::new(SlideBranch::Behind, SlideBranch::Behind),
        Self::new(SlideBranch::Ahead, SlideBranch::Ahead),
        Self::new(SlideBranch::Ahead, SlideBranch::Behind),
    ];

    /// The usual mode: the sliders are outside the platform's ends.
    pub const APART: Self = Self::new(SlideBranch::Behind, SlideBranch::Ahead);

    /// The mode with these sides of the left and right slider.
    pub const fn new(left: SlideBranch, right: SlideBranch) -> Self {
        Self { left, right }
    }
}

/// A closed configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<S> {
    /// P [m].
    pub p: Vector2<S>,
    /// x2, the left slider [m].
    pub x2: S,
    /// x8, the right slider [m].
    pub x8: S,
    /// u(α3), up the left limb.
    pub u3: Vector2<S>,
    /// u(α7), up the right limb.
    pub u7: Vector2<S>,
}

impl<S: Scalar> Pose<S> {
    /// The assembly mode: `Left` where P is above the guide, to the left of +x.
    pub fn assembly(&self) -> Side {
        Side::of(self.p.y)
    }

    /// The working mode.
    pub fn working_mode(&self) -> WorkingMode {
        let branch = |cosine: S| {
            if cosine > S::ZERO {
                SlideBranch::Behind
            } else {
                SlideBranch::Ahead
            }
        };
        WorkingMode::new(branch(self.u3.x), branch(self.u7.x))
    }

    /// α3 and α7 [rad].
    pub fn angles(&self) -> [S; 2] {
        [self.u3.polar_angle(), self.u7.polar_angle()]
    }

    /// S = sin(α7−α3): zero where the limbs are parallel or in line (type 2).
    #[inline]
    pub fn sin73(&self) -> S {
        self.u3.cross_z(self.u7)
    }
}

impl<S: Scalar> Geometry<S> {
    /// The pose with the sliders at `x2` and `x8` [m]: P where the circles about
    /// (x2 + l5/2, 0) and (x8 − l5/2, 0) meet. With d between their centres,
    /// a = ½(1 + (l3² − l7²)/d²), xP = x2 + l5/2 + a d, yP = ±√(l3² − a² d²).
    ///
    /// # Errors
    /// `SlidersTooFar`, `SlidersTooNear`; `Parallel` where equal limbs coincide.
    pub fn forward(&self, x2: S, x8: S, assembly: Side) -> Result<Pose<S>, PoseError> {
        if !(x2.is_finite() && x8.is_finite()) {
            return Err(PoseError::NotFinite);
        }
        let (l3, l7) = (self.l3(), self.l7());
        let c2 = x2 + self.half_platform();
        let c8 = x8 - self.half_platform();
        let d = c8 - c2;
        let d_squared = d * d;
        if d_squared == S::ZERO {
            return Err(if l3 == l7 {
                PoseError::Parallel
            } else {
                PoseError::SlidersTooNear
            });
        }
        let foot = S::HALF * (d + (l3 * l3 - l7 * l7) / d);
        let y_squared = l3 * l3 - foot * foot;
        if y_squared < S::ZERO {
            return Err(if d_squared > l3 * l3 + l7 * l7 {
                PoseError::SlidersTooFar
            } else {
                PoseError::SlidersTooNear
            });
        }
        let y = assembly.sign(y_squared.sqrt());
        Ok(Pose {
            p: Vector2::new(c2 + foot, y),
            x2,
            x8,
            u3: Vector2::new(foot, y) * (S::ONE / l3),
            u7: Vector2::new(foot - d, y) * (S::ONE / l7),
        })
    }

    /// The pose with P at `p` [m]: x2 = xP − l5/2 ∓ √(l3² − y²),
    /// x8 = xP + l5/2 ∓ √(l7² − y²), the upper sign where the slider is `Behind`.
    ///
    /// # Errors
    /// `LimbTooShort`.
    pub fn inverse(&self, p: Vector2<S>, mode: WorkingMode) -> Result<Pose<S>, PoseError> {
        if !(p.x.is_finite() && p.y.is_finite()) {
            return Err(PoseError::NotFinite);
        }
        let up = |length: S, branch: SlideBranch, limb: Limb| {
            let h_squared = length * length - p.y * p.y;
            if h_squared < S::ZERO {
                return Err(PoseError::LimbTooShort(limb));
            }
            // With the slider behind, the limb points ahead: cos α > 0.
            Ok(branch.opposite().sign(h_squared.sqrt()))
        };
        let (l3, l7) = (self.l3(), self.l7());
        let h3 = up(l3, mode.left, Limb::Left)?;
        let h7 = up(l7, mode.right, Limb::Right)?;
        Ok(Pose {
            p,
            x2: p.x - self.half_platform() - h3,
            x8: p.x + self.half_platform() - h7,
            u3: Vector2::new(h3, p.y) * (S::ONE / l3),
            u7: Vector2::new(h7, p.y) * (S::ONE / l7),
        })
    }
}
