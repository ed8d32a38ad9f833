//! Settings that have been checked, with the models that they describe.

use super::Settings;
use core::ops::Deref;
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::Tool;

/// Settings that [`Settings::check`] has found valid, with the models that they describe.
///
/// They read like [`Settings`] and cannot be changed. The controller, the planner and the session
/// take no others, so settings are checked once, where they enter the program:
///
/// ```
/// use fivebar_firmware::{Controller, Settings};
///
/// # fn main() -> Result<(), fivebar_firmware::settings::SettingsError> {
/// let settings = Settings::BENCHTOP.check()?;
/// let controller = Controller::new(&settings);
/// # Ok(())
/// # }
/// ```
///
/// Settings that were not checked do not compile:
///
/// ```compile_fail,E0308
/// use fivebar_firmware::{Controller, Settings};
///
/// let controller = Controller::new(&Settings::BENCHTOP);
/// ```
///
/// and neither does a change after the check:
///
/// ```compile_fail,E0594
/// use fivebar_firmware::Settings;
///
/// # fn main() -> Result<(), fivebar_firmware::settings::SettingsError> {
/// let mut settings = Settings::BENCHTOP.check()?;
/// settings.payload = -1.0;
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct CheckedSettings {
    pub(super) settings: Settings,
    pub(super) arm: Arm<f32>,
    pub(super) tool: Tool<f32>,
    pub(super) nominal_inertia: [f32; 2],
}

impl CheckedSettings {
    /// Geometry and inertia, with the rotors as seen through their gears.
    pub fn arm(&self) -> &Arm<f32> {
        &self.arm
    }

    /// The geometry with the tool.
    pub fn tool(&self) -> &Tool<f32> {
        &self.tool
    }

    /// The inertia [kg·m²] of each joint with the other joint at rest, averaged over the poses
    /// that the arm can take: the constant of independent-joint control.
    pub fn nominal_inertia(&self) -> [f32; 2] {
        self.nominal_inertia
    }
}

impl Deref for CheckedSettings {
    type Target = Settings;

    fn deref(&self) -> &Settings {
        &self.settings
    }
}
