//! The angles that the driven joints may have.

use super::Joint;
use crate::Scalar;
use core::f64::consts::PI;
use core::fmt;

/// Why angles are refused, and of which joint.
///
/// ```
/// use fivebar_kinematics::five_bar::{Joint, JointLimitError, JointLimits};
///
/// let limits = JointLimits::new([0.5, 2.6], [-0.5, 1.6])?; // rad
/// assert_eq!(limits.angles_within(2.7, 1.0), Err(JointLimitError::Outside(Joint::Joint1)));
/// # Ok::<(), JointLimitError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum JointLimitError {
    /// The limits given are not −3π ≤ least < greatest ≤ 3π.
    Range(Joint),
    /// The joint cannot point there within its limits.
    Outside(Joint),
}

impl JointLimitError {
    /// The joint.
    pub fn joint(self) -> Joint {
        match self {
            Self::Range(joint) | Self::Outside(joint) => joint,
        }
    }
}

impl fmt::Display for JointLimitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Range(joint) => write!(
                f,
                "the limits of {joint} must be within one and a half turns of 0, the smaller first"
            ),
            Self::Outside(joint) => write!(f, "{joint} would leave its limits"),
        }
    }
}

impl core::error::Error for JointLimitError {}

/// Least and greatest angle of each driven joint [rad], within one and a half turns of 0.
///
/// ```
/// use fivebar_kinematics::five_bar::JointLimits;
/// use core::f64::consts::PI;
///
/// let limits = JointLimits::new([0.5, 4.0], [-1.0, 1.0])?; // rad
/// // Link 1 at −170° is within its limits after a whole turn: 190° = 3.3 rad.
/// let [theta1, theta4] = limits.angles_within(-170.0 * PI / 180.0, 0.2)?;
/// assert!((theta1 - 190.0 * PI / 180.0).abs() < 1e-15);
/// assert_eq!(theta4, 0.2);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits<S> {
    joint1: [S; 2],
    joint4: [S; 2],
}

impl<S: Scalar> JointLimits<S> {
    /// Limits from `[least, greatest]` of θ1 and of θ4 [rad].
    ///
    /// # Errors
    /// `Range` with the joint whose limits are not −3π ≤ least < greatest ≤ 3π.
    pub fn new(joint1: [S; 2], joint4: [S; 2]) -> Result<Self, JointLimitError> {
        for (joint, [least, greatest]) in [(Joint::Joint1, joint1), (Joint::Joint4, joint4)] {
            let bound = S::from_f64(3.0 * PI);
            if !(-bound <= least && least < greatest && greatest <= bound) {
                return Err(JointLimitError::Range(joint));
            }
        }
        Ok(Self { joint1, joint4 })
    }

    /// Least and greatest θ1 and θ4 [rad].
    pub fn ranges(&self) -> [[S; 2]; 2] {
        [self.joint1, self.joint4]
    }

    /// The given directions θ1, θ4 ∈ (−π, π] as joint angles within the limits: a whole
    /// turn is added or taken where only that one is allowed.
    ///
    /// # Errors
    /// `Outside` with the joint that cannot point there.
    pub fn angles_within(&self, theta1: S, theta4: S) -> Result<[S; 2], JointLimitError> {
        Ok([
            within(theta1, self.joint1).ok_or(JointLimitError::Outside(Joint::Joint1))?,
            within(theta4, self.joint4).ok_or(JointLimitError::Outside(Joint::Joint4))?,
        ])
    }
}

fn within<S: Scalar>(theta: S, [least, greatest]: [S; 2]) -> Option<S> {
    let turn = S::from_f64(2.0 * PI);
    [theta, theta - turn, theta + turn]
        .into_iter()
        .find(|&angle| least <= angle && angle <= greatest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_is_found_on_the_turn_that_is_allowed() {
        let limits = JointLimits::new([0.5, 4.0], [-1.0, 1.0]).unwrap();
        assert_eq!(limits.angles_within(1.0, 0.0), Ok([1.0, 0.0]));
        let [theta1, _] = limits.angles_within(-2.9, 0.0).unwrap();
        assert!((theta1 - (2.0 * PI - 2.9)).abs() < 1e-15);
        let negative = JointLimits::new([-4.0, -0.5], [-1.0, 1.0]).unwrap();
        let [theta1, _] = negative.angles_within(2.9, 0.0).unwrap();
        assert!((theta1 - (2.9 - 2.0 * PI)).abs() < 1e-15);
        let outside = |joint| Err(JointLimitError::Outside(joint));
        assert_eq!(limits.angles_within(0.4, 0.0), outside(Joint::Joint1));
        assert_eq!(limits.angles_within(1.0, 1.1), outside(Joint::Joint4));
        assert_eq!(limits.angles_within(f64::NAN, 0.0), outside(Joint::Joint1));
    }

    #[test]
    fn empty_boundless_or_undefined_limits_are_refused() {
        let good = [-1.0, 1.0];
        for bad in [[1.0, 1.0], [1.0, -1.0], [-1.0, 10.0], [f64::NAN, 1.0]] {
            let refused = |joint| Err(JointLimitError::Range(joint));
            assert_eq!(JointLimits::new(bad, good), refused(Joint::Joint1));
            assert_eq!(JointLimits::new(good, bad), refused(Joint::Joint4));
        }
    }
}
