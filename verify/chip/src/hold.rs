//! A hand that holds the arm, and moves it to another place.

use crate::time::{SECOND, Time};
use fivebar_kinematics::five_bar::{Geometry, Joint, Pose, Side};

/// Time in which a hand turns the arm to another place.
pub const HAND_TIME: Time = SECOND / 5;

/// A path along which a hand moves the arm: from the angles of both joints, by so much, since a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hold {
    pub(crate) from: [f64; 2],
    pub(crate) by: [f64; 2],
    pub(crate) since: Time,
    pub(crate) geometry: Geometry<f64>,
    pub(crate) assembly: Side,
}

impl Hold {
    /// Where the arm is at a time.
    pub(crate) fn pose(&self, at: Time) -> Option<Pose<f64>> {
        let share = (at.saturating_sub(self.since) as f64 / HAND_TIME as f64).min(1.0);
        let smooth = share * share * (3.0 - 2.0 * share);
        let angle = |joint: Joint| self.from[joint] + smooth * self.by[joint];
        let Self {
            geometry, assembly, ..
        } = self;
        let [theta1, theta4] = Joint::ALL.map(angle);
        geometry.forward(theta1, theta4, *assembly).ok()
    }
}
