//! The reach of P within the sliders' travel.
//!
//! At each height y each slider's travel, shifted, is the interval of x that its limb allows.
//! P reaches their intersection, x ∈ [x2 + l5/2 + h3] ∩ [x8 − l5/2 + h7], for
//! |y| ≤ min(l3, l7), with h = l cos α; the working mode gives the sign of h.

use super::{Geometry, Pose, PoseError, WorkingMode};
use fivebar_kinematics::Scalar;
use nalgebra::Vector2;

/// The travel of each slider: its least and greatest position [m].
///
/// ```
/// use fivebar_design::slider::{Geometry, Travel, WorkingMode};
///
/// let geometry = Geometry::new(1.2_f64, 1.1, 0.6)?;
/// let travel = Travel { left: [-2.0, 0.0], right: [0.0, 2.0] }; // m
/// let [least, greatest] = geometry.reachable_at(0.9, WorkingMode::APART, &travel)?;
/// assert!(least < 0.0 && greatest > 0.0);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travel<S> {
    /// Of slider 2.
    pub left: [S; 2],
    /// Of slider 8.
    pub right: [S; 2],
}

impl<S: Scalar> Travel<S> {
    /// Whether both sliders of a pose are within their travel.
    pub fn contains(&self, pose: &Pose<S>) -> bool {
        let within = |x: S, [least, greatest]: [S; 2]| least <= x && x <= greatest;
        within(pose.x2, self.left) && within(pose.x8, self.right)
    }
}

impl<S: Scalar> Geometry<S> {
    /// The least and greatest x [m] that P can reach at height `y` [m] in a working mode.
    ///
    /// # Errors
    /// `LimbTooShort` above and below the workspace, `BeyondTravel` where the distance
    /// between the sliders that this height needs is beyond their travel.
    pub fn reachable_at(
        &self,
        y: S,
        mode: WorkingMode,
        travel: &Travel<S>,
    ) -> Result<[S; 2], PoseError> {
        // The sliders' offsets from P are the same for all positions along the guide.
        let pose = self.inverse(Vector2::new(S::ZERO, y), mode)?;
        let from = |[least, greatest]: [S; 2], offset: S| [least - offset, greatest - offset];
        let [least3, greatest3] = from(travel.left, pose.x2);
        let [least7, greatest7] = from(travel.right, pose.x8);
        let least = if least3 > least7 { least3 } else { least7 };
        let greatest = if greatest3 < greatest7 {
            greatest3
        } else {
            greatest7
        };
        if least <= greatest {
            Ok([least, greatest])
        } else {
            Err(PoseError::BeyondTravel)
        }
    }

    /// The area of the workspace on one side of the guide [m²], by the midpoint rule with
    /// `slices` of equal angle φ, y = l sin φ. So the slices are thinnest near the top, where
    /// their width changes fastest.
    pub fn workspace_area(&self, mode: WorkingMode, travel: &Travel<S>, slices: u32) -> S {
        let (l3, l7) = (self.l3(), self.l7());
        let shorter = if l3 < l7 { l3 } else { l7 };
        let step = S::from_f64(core::f64::consts::FRAC_PI_2 / f64::from(slices));
        (0..slices).fold(S::ZERO, |area, slice| {
            let phi = step * S::from_f64(f64::from(slice) + 0.5);
            let (sin, cos) = phi.sin_cos();
            match self.reachable_at(shorter * sin, mode, travel) {
                Ok([least, greatest]) => area + (greatest - least) * shorter * cos * step,
                Err(_) => area,
            }
        })
    }
}
