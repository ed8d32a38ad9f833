//! Arms with hobby servos: gear, motor and position loop in one case, which read their set-point from the width of a
//! pulse.

mod plant;
mod servo;

use crate::fault::FaultKind;
pub use plant::HobbyServoPlant;
pub use servo::HobbyServo;

impl FaultKind {
    /// Whether it can happen to an arm with hobby servos: what happens to steppers, without their steps.
    pub fn is_of_hobby_servos(&self) -> bool {
        self.is_of_steppers() && !matches!(self, Self::StepLost { .. } | Self::PhaseOpen { .. })
    }
}
