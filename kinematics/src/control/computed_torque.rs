//! Computed torque: τ = M(q) α + h(q, q̇) at the measured state, α being the demanded
//! acceleration, which goes straight through inverse dynamics so that M is never formed.

use crate::dynamics::Arm;
use crate::five_bar::{Pose, PoseError, Velocities};
use crate::{Scalar, Vec2};

/// The torques [N·m] that accelerate the driven joints by `alpha` [rad/s²] from the
/// measured pose and velocities. Without friction.
///
/// # Errors
/// `Singular` at type 2.
#[inline]
pub fn computed_torque<S: Scalar>(
    arm: &Arm<S>,
    pose: &Pose<S>,
    velocities: &Velocities<S>,
    alpha: [S; 2],
) -> Result<[S; 2], PoseError> {
    let [alpha1, alpha4] = alpha;
    let accelerations = arm
        .geometry()
        .forward_accelerations(pose, velocities, alpha1, alpha4)?;
    arm.inverse_dynamics(pose, velocities, &accelerations, Vec2::zero())
}

/// The greatest torques of the two joints [N·m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLimit<S>(pub [S; 2]);

impl<S: Scalar> TorqueLimit<S> {
    /// The torques shortened by one common factor until both are within their limits, so
    /// that their direction is kept; and whether that was needed.
    #[inline]
    pub fn apply(&self, torque: [S; 2]) -> ([S; 2], bool) {
        let [torque1, torque4] = torque;
        let [limit1, limit4] = self.0;
        let (size1, size4) = (torque1.abs(), torque4.abs());
        if size1 <= limit1 && size4 <= limit4 {
            return (torque, false);
        }
        // min(limit1/size1, limit4/size4), compared without dividing by a zero.
        let factor = if limit1 * size4 <= limit4 * size1 {
            limit1 / size1
        } else {
            limit4 / size4
        };
        ([torque1 * factor, torque4 * factor], true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn limited_torque_keeps_its_direction_and_touches_a_limit(
            torque in prop::array::uniform2(-50.0..50.0_f64),
            limit in prop::array::uniform2(0.1..10.0_f64),
        ) {
            let ([t1, t4], limited) = TorqueLimit(limit).apply(torque);
            let share = (t1.abs() / limit[0]).max(t4.abs() / limit[1]);
            prop_assert!(share <= 1.0 + 1e-12);
            prop_assert!((t1 * torque[1] - t4 * torque[0]).abs() <= 1e-9);
            prop_assert!(t1 * torque[0] + t4 * torque[1] >= 0.0);
            if limited {
                prop_assert!((share - 1.0).abs() <= 1e-12);
            } else {
                prop_assert_eq!([t1, t4], torque);
            }
        }
    }

    #[test]
    fn a_torque_that_is_not_a_number_stays_one() {
        let ([t1, _], limited) = TorqueLimit([1.0, 1.0]).apply([f64::NAN, 0.0]);
        assert!(limited && t1.is_nan());
    }
}
