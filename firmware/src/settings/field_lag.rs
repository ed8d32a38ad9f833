//! How far a stepper's rotor lags behind its field because the supply is too low for its speed.

use fivebar_kinematics::Scalar;
use serde::{Deserialize, Serialize};

/// The greatest lag [rad of the field]: at π/2 more than without one the motor gives no more torque.
const MOST: f32 = 2.0;

/// The lag of a rotor without load, d = e (s − b e) with e = |ω| − ω₀ at the joint's speed ω; none below ω₀. It adds to
/// the angle of the load. All zero: the rotor does not lag, or by how much is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FieldLag {
    /// ω₀, the joint's speed from which on the rotor lags [rad/s].
    pub from: f32,
    /// s, by how much the lag grows there [rad of the field per rad/s].
    pub slope: f32,
    /// b, by how much that falls with the speed [rad of the field per (rad/s)²].
    pub bend: f32,
}

impl FieldLag {
    /// None.
    pub const NONE: Self = Self {
        from: 0.0,
        slope: 0.0,
        bend: 0.0,
    };

    /// The lag at this speed of the joint [rad/s], with the speed's sign [rad of the field]; at most 2 rad.
    #[inline(always)]
    pub fn at(&self, speed: f32) -> f32 {
        // Comparisons, because `max` and `min` are calls on the microcontroller; of what is not a number there is none.
        let excess = Scalar::abs(speed) - self.from;
        let lag = excess * (self.slope - self.bend * excess);
        let lag = if excess > 0.0 && lag > 0.0 { lag } else { 0.0 };
        let lag = if lag < MOST { lag } else { MOST };
        if speed < 0.0 { -lag } else { lag }
    }

    /// Whether all numbers are finite and none is negative.
    pub(super) fn is_sound(&self) -> bool {
        let Self { from, slope, bend } = *self;
        [from, slope, bend]
            .iter()
            .all(|number| (0.0..=1e6).contains(number))
    }
}

#[cfg(test)]
mod tests {
    use super::FieldLag;

    #[test]
    fn the_lag_is_a_parabola_from_a_speed_on_and_bounded() {
        let lag = FieldLag {
            from: 14.0,
            slope: 0.09,
            bend: 5e-4,
        };
        for (speed, expected) in [(0.0, 0.0), (14.0, 0.0), (18.0, 0.352), (24.0, 0.85)] {
            assert!((lag.at(speed) - expected).abs() < 1e-6, "{speed}");
            assert!((lag.at(-speed) + expected).abs() < 1e-6, "{speed}");
        }
        // Behind its top the parabola falls below 0.
        assert_eq!(lag.at(1e3), 0.0);
        assert_eq!(lag.at(f32::NAN), 0.0);
        assert_eq!(lag.at(f32::INFINITY), 0.0);
        let steep = FieldLag { bend: 0.0, ..lag };
        assert_eq!(steep.at(1e6), 2.0);
        assert_eq!(FieldLag::NONE.at(100.0), 0.0);
    }
}
