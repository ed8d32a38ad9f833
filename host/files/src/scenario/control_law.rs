//! How the controller finds the torques that follow a reference.

use std::fmt;

/// The control law of a run. A scenario file has it as `computed_torque`, true or false.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlLaw {
    /// The torques come from the model of the arm.
    ComputedTorque,
    /// Each joint has a PID of its own, with feed-forward of acceleration and friction.
    Pid,
}

impl ControlLaw {
    /// Computed torque if the file's key is true, else PID.
    pub fn from_key(computed_torque: bool) -> Self {
        if computed_torque {
            Self::ComputedTorque
        } else {
            Self::Pid
        }
    }

    /// The value of the file's key.
    pub fn is_computed_torque(self) -> bool {
        self == Self::ComputedTorque
    }
}

impl fmt::Display for ControlLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ComputedTorque => "computed torque",
            Self::Pid => "PID at each joint with feed-forward",
        })
    }
}
