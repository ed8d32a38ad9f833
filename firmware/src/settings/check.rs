//! The check of settings, field by field.

use super::{AxisField, CheckedSettings, Field, Settings, SettingsError};
use core::ops::ControlFlow;
use fivebar_kinematics::dynamics::{Arm, ModelError};
use fivebar_kinematics::five_bar::Tool;
use heapless::Vec;

/// More faults than settings can have: those of two axes, of the other fields, and of the arm.
const MOST_FAULTS: usize = 2 * AxisField::ALL.len() + Field::ALL.len() + 1;

impl Settings {
    /// Checks every field, and that the arm which they describe can take a pose.
    ///
    /// # Errors
    /// The first field that is invalid, by name.
    #[inline(never)]
    pub fn check(&self) -> Result<CheckedSettings, SettingsError> {
        if let ControlFlow::Break(error) = self.each_broken(ControlFlow::Break) {
            return Err(error);
        }
        let (arm, tool) = self.models()?;
        Ok(CheckedSettings {
            nominal_inertia: self.nominal_inertia(&arm, &tool)?,
            settings: *self,
            arm,
            tool,
        })
    }

    /// Everything that is wrong with the settings; nothing if [`check`](Self::check) accepts them.
    /// A field that is compared with one that is itself invalid is not named.
    ///
    /// ```
    /// use fivebar_firmware::Settings;
    ///
    /// let mut settings = Settings::BENCHTOP;
    /// settings.control.damping = 9.0;
    /// settings.axes[1].resistance = -2.3;
    /// let faults = settings.faults();
    /// assert_eq!(faults[0].to_string(), "joint 4: resistance must lie in 1e-5 to 1e5 Ω");
    /// assert_eq!(faults[1].to_string(), "control.damping must lie in 0.2 to 2");
    /// assert_eq!(faults.len(), 2);
    /// ```
    pub fn faults(&self) -> Vec<SettingsError, MOST_FAULTS> {
        let mut broken: Vec<_, MOST_FAULTS> = Vec::new();
        let _ = self.each_broken(|error| {
            if !broken.contains(&error) {
                // It has room for every field.
                let _ = broken.push(error);
            }
            ControlFlow::Continue(())
        });
        let mut faults: Vec<_, MOST_FAULTS> = broken
            .iter()
            .filter(|error| !self.follows(error))
            .copied()
            .collect();
        let of_the_arm = match self.models() {
            // Of an axis, which is named already.
            Err(SettingsError::Inertia(ModelError::RotorInertia)) if !broken.is_empty() => None,
            Err(error) => Some(error),
            Ok((arm, tool)) if broken.is_empty() => self.nominal_inertia(&arm, &tool).err(),
            Ok(_) => None,
        };
        faults.extend(of_the_arm);
        faults
    }

    /// Whether an error may follow from those of the fields that its field is compared with.
    fn follows(&self, error: &SettingsError) -> bool {
        let [axis1, axis4] = &self.axes;
        let of_joint = |joint| if joint == 1 { [axis1; 2] } else { [axis4; 2] };
        let (axes, (fields, of_axes)) = match *error {
            // Its own bounds, or its share of the stall current.
            SettingsError::Axis(joint, AxisField::PeakCurrent) => {
                let axes = of_joint(joint);
                let beside: (&[_], &[_]) = (&[Field::BusVoltage], &[AxisField::Resistance]);
                if !axes.iter().all(|axis| AxisField::PeakCurrent.holds(axis)) {
                    return false;
                }
                (axes, beside)
            }
            SettingsError::Axis(joint, field) => (of_joint(joint), field.beside()),
            SettingsError::Field(field) => ([axis1, axis4], field.beside()),
            _ => return false,
        };
        fields.iter().any(|field| !field.holds(self))
            || of_axes
                .iter()
                .any(|field| axes.iter().any(|axis| !field.holds(axis)))
    }

    /// Tells of each field that is invalid, in this order, until `tell` breaks off.
    fn each_broken(
        &self,
        mut tell: impl FnMut(SettingsError) -> ControlFlow<SettingsError>,
    ) -> ControlFlow<SettingsError> {
        for (joint, axis) in [1, 4].into_iter().zip(&self.axes) {
            for field in AxisField::ALL {
                if !field.holds(axis) {
                    tell(SettingsError::Axis(joint, *field))?;
                }
            }
        }
        for (joint, table) in [1, 4].into_iter().zip(&self.encoder_tables) {
            if !table.is_sound() {
                tell(SettingsError::Axis(joint, AxisField::EncoderTable))?;
            }
        }
        // The currents are compared with the bus voltage, which must be valid itself.
        let (arm, tool) = Field::ALL.split_at(Field::ToolFrameRate as usize);
        for field in arm {
            if !field.holds(self) {
                tell(SettingsError::Field(*field))?;
            }
        }
        for (joint, axis) in [1, 4].into_iter().zip(&self.axes) {
            if self.is_overloaded(axis) {
                tell(SettingsError::Axis(joint, AxisField::PeakCurrent))?;
            }
        }
        for field in tool {
            if !field.holds(self) {
                tell(SettingsError::Field(*field))?;
            }
        }
        ControlFlow::Continue(())
    }

    /// The arm, and its tool.
    fn models(&self) -> Result<(Arm<f32>, Tool<f32>), SettingsError> {
        let arm = self.arm()?;
        let tool = self.tool(&arm)?;
        Ok((arm, tool))
    }
}
