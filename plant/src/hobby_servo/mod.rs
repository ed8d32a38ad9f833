//! Arms with hobby servos: gear, motor and position loop in one case, which read their set-point from the width of a
//! pulse.

mod plant;
mod servo;

use crate::fault::FaultKind;
use crate::mismatch::Mismatch;
pub use plant::HobbyServoPlant;
pub use servo::HobbyServo;

impl Mismatch {
    /// The name of the first effect of a belt's pulleys: a hobby servo turns its joint by a horn.
    pub fn effect_of_pulleys(&self) -> Option<&'static str> {
        let effects = [
            ("pulley_run_out", self.pulley_run_out),
            ("tooth_mesh", self.tooth_mesh),
        ];
        let on = effects.into_iter().find(|(_, value)| *value != [0.0; 2]);
        on.map(|(name, _)| name)
    }
}

impl FaultKind {
    /// Whether it can happen to an arm with hobby servos: what happens to steppers, without their steps.
    pub fn is_of_hobby_servos(&self) -> bool {
        self.is_of_steppers() && !matches!(self, Self::StepLost { .. } | Self::PhaseOpen { .. })
    }
}
