//! A hard stop at the end of a joint's travel: a stiff spring with a damper, which only pushes.

use crate::sensors::JointSensors;

/// Stiffness of a stop at its joint [N·m/rad].
const STIFFNESS: f64 = 1000.0;
/// Damping of a stop at its joint [N·m·s/rad].
const DAMPING: f64 = 1.0;

/// The stop of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HardStop {
    /// The joint's angle where it touches [rad].
    angle: f64,
    /// Whether the joint's angle grows towards it.
    forward: bool,
}

impl HardStop {
    /// A stop where a joint with these sensors would have its home switch.
    pub(crate) fn at_home(sensors: &JointSensors) -> Self {
        Self {
            angle: sensors.home,
            forward: sensors.home_forward,
        }
    }

    /// Its torque on the joint [N·m] at this angle [rad] and speed [rad/s].
    pub(crate) fn torque(&self, angle: f64, speed: f64) -> f64 {
        let towards = if self.forward { 1.0 } else { -1.0 };
        let depth = towards * (angle - self.angle);
        if depth <= 0.0 {
            return 0.0;
        }
        let push = STIFFNESS * depth + DAMPING * towards * speed;
        -towards * push.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::HardStop;

    #[test]
    fn a_stop_pushes_back_behind_its_angle_and_never_pulls() {
        for (forward, towards) in [(true, 1.0), (false, -1.0)] {
            let stop = HardStop {
                angle: towards * 2.0,
                forward,
            };
            assert_eq!(stop.torque(towards * 1.999, towards * 3.0), 0.0);
            assert!((stop.torque(towards * 2.001, 0.0) + towards).abs() < 1e-9);
            assert!((stop.torque(towards * 2.001, towards) + 2.0 * towards).abs() < 1e-9);
            assert_eq!(stop.torque(towards * 2.001, -2.0 * towards), -0.0 * towards);
        }
    }
}
