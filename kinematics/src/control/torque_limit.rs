//! The torque limit: both torques are scaled by one factor.

use crate::Scalar;

/// The greatest torques of the two joints [N·m].
///
/// ```
/// use fivebar_kinematics::control::TorqueLimit;
///
/// let limit = TorqueLimit([1.0, 1.0]); // N·m
/// assert_eq!(limit.apply([0.4, -0.9]), ([0.4, -0.9], false));
/// // Joint 4 asks for four times its limit: both torques are divided by four.
/// assert_eq!(limit.apply([2.0, -4.0]), ([0.5, -1.0], true));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLimit<S>(pub [S; 2]);

impl<S: Scalar> TorqueLimit<S> {
    /// The torques, scaled by one common factor if one exceeds its limit, so that their ratio
    /// is kept; and whether they were scaled.
    #[inline(always)]
    pub fn apply(&self, torque: [S; 2]) -> ([S; 2], bool) {
        match self.factor(torque) {
            Some(factor) => (torque.map(|torque| torque * factor), true),
            None => (torque, false),
        }
    }

    /// By how much the torques are scaled if one exceeds its limit.
    #[inline(always)]
    pub fn factor(&self, [torque1, torque4]: [S; 2]) -> Option<S> {
        let [limit1, limit4] = self.0;
        let (size1, size4) = (torque1.abs(), torque4.abs());
        (size1 > limit1 || size4 > limit4).then(|| {
            // A torque of zero has an infinite share.
            let (share1, share4) = (limit1 / size1, limit4 / size4);
            if share1 < share4 { share1 } else { share4 }
        })
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
    fn a_torque_at_its_limit_is_not_limited() {
        let limit = TorqueLimit([1.5, 0.7]);
        for torque in [[1.5, 0.0], [0.0, -0.7], [-1.5, 0.7]] {
            assert_eq!(limit.apply(torque), (torque, false));
        }
    }

    #[test]
    fn a_torque_that_is_not_a_number_stays_one() {
        for other in [0.0, 2.0] {
            let ([t1, _], _) = TorqueLimit([1.0, 1.0]).apply([f64::NAN, other]);
            assert!(t1.is_nan());
        }
    }
}
