//! The displacement of P by small errors of the lengths and of the sliders, to first order.
//!
//! e3 = δl3 + cos α3 (δl5/2 + δx2), e7 = δl7 + cos α7 (δx8 − δl5/2), S = sin(α7−α3):
//!
//! δxP = (sin α7 e3 − sin α3 e7)/S, δyP = (cos α3 e7 − cos α7 e3)/S.
//!
//! **Erratum**: Tu 2005 differentiates at fixed α, which gives δxP/δl3 = cos α3. That is
//! wrong: with the sliders as inputs the limbs turn when their lengths change.

use super::{Geometry, Pose, PoseError};
use fivebar_kinematics::Scalar;
use nalgebra::Vector2;

/// The derivative of P's position with respect to each length and slider [m/m].
///
/// ```
/// use fivebar_design::slider::{Geometry, WorkingMode};
/// use nalgebra::Vector2;
///
/// let geometry = Geometry::new(1.2_f64, 1.1, 0.6)?;
/// let pose = geometry.inverse(Vector2::new(0.0, 0.9), WorkingMode::APART)?;
/// let transfer = geometry.error_transfer(&pose)?;
/// // A left limb that is 1 µm too long moves P as the exact solution does.
/// let longer = Geometry::new(1.2 + 1e-6, 1.1, 0.6)?.forward(pose.x2, pose.x8, pose.assembly())?;
/// assert!(((longer.p - pose.p) / 1e-6 - transfer.l3).norm() < 1e-5);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorTransfer<S> {
    /// By the left limb's length.
    pub l3: Vector2<S>,
    /// By the right limb's length.
    pub l7: Vector2<S>,
    /// By the platform's width.
    pub l5: Vector2<S>,
    /// By the left slider's position.
    pub x2: Vector2<S>,
    /// By the right slider's position.
    pub x8: Vector2<S>,
}

impl<S: Scalar> Geometry<S> {
    /// The error transfer coefficients at a pose.
    ///
    /// # Errors
    /// `Parallel`.
    pub fn error_transfer(&self, pose: &Pose<S>) -> Result<ErrorTransfer<S>, PoseError> {
        let (c3, c7) = (pose.u3.x, pose.u7.x);
        Ok(ErrorTransfer {
            l3: pose.solve(S::ONE, S::ZERO)?,
            l7: pose.solve(S::ZERO, S::ONE)?,
            l5: pose.solve(S::HALF * c3, -S::HALF * c7)?,
            x2: pose.solve(c3, S::ZERO)?,
            x8: pose.solve(S::ZERO, c7)?,
        })
    }
}
