//! Robots: read from TOML and checked once; models and the controller's settings are made
//! from them.

mod actuator;
mod actuator_file;
mod actuators;
mod belts;
mod builtin;
mod bus_servo;
mod can_torque;
mod check;
mod consistency;
mod crossing;
mod draft;
mod draft_motors;
mod drive;
mod drive_kind;
mod file;
mod hobby_servo;
mod home;
mod home_index;
mod home_method;
mod homing;
mod links;
mod macros;
mod measured;
mod newest;
mod plausible;
mod proposed_limits;
mod sections;
mod servo;
mod settings;
mod slider;
mod stepper;
mod template;
mod tolerance;
mod tool_output;
mod torque_limit;
mod value;
mod workspace;

pub use actuator::{Actuator, CanTorque, Drive, HobbyServo, Stepper};
pub use builtin::{BUILT_IN, BuiltIn};
pub use bus_servo::BusServos;
pub use consistency::robot_file_message;
pub use crossing::CrossingRefusal;
pub use draft::{Draft, DraftError};
pub use draft_motors::{CanMotor, CanProtocol, Motor, Motors, ServoMotor, StepperMotor};
pub use drive_kind::{DriveKind, NotBrushed};
pub use home::HomeError;
pub use home_method::HomeMethod;
pub use homing::HomeSearch;
pub use measured::{Measured, MeasuredKey, measured_text, today};
pub use sections::{Control, Crossing, Limits, Protection, Supply, Tool, ToolLimits};
pub use slider::{Mechanism, SliderRobot};
pub use torque_limit::TorqueLimit;
pub use workspace::WorkspaceError;

use crate::did_you_mean;
use crate::refusal::Key;
use crate::source::{FileError, Source};
use crate::text_file;
use fivebar_design::accuracy::five_bar::{ArmTolerance, TolerancedArm};
use fivebar_design::servo::BeltTuning;
use fivebar_firmware::settings::{AdvancedSettings, ToolOutputSettings};
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{Geometry, WorkingMode};
use fivebar_plant::contact::Contact;
use nalgebra::Vector2;
use std::collections::BTreeMap;

/// A robot from a file, checked.
///
/// ```
/// use fivebar_files::robot::Robot;
///
/// let robot = Robot::load("benchtop")?;
/// assert_eq!(robot.geometry.lengths(), [0.10, 0.16, 0.16, 0.10, 0.08]); // m
/// let error = Robot::parse("arm.toml", "name = \"arm\"\nbase = -0.1\n").unwrap_err();
/// assert!(error.to_string().starts_with("arm.toml"));
/// # Ok::<(), fivebar_files::source::FileError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// Its name.
    pub name: String,
    /// l1…l4 and the base; they can be assembled.
    pub geometry: Geometry<f64>,
    /// Gravity in the plane [m/s²].
    pub gravity: Vector2<f64>,
    /// The equations of motion with the rotors; none for a robot with lengths only.
    arm: Option<Arm<f64>>,
    /// The sides to which the elbows of the legs A–B–C and E–D–C turn, from the file: the
    /// working mode of C. [`Robot::working_mode`] is that of the tool.
    pub elbows: WorkingMode,
    /// θ1, θ4 at the home switches [rad].
    pub home: [f64; 2],
    /// The drives of joint 1 and joint 4; without them, ideal torque sources.
    pub actuators: Option<[Actuator; 2]>,
    /// The tool on link 2.
    pub tool: Tool,
    /// The output for the tool.
    pub tool_output: ToolOutputSettings,
    /// S of M3 and M4 for a tool of two states, if the file states them.
    pub(crate) tool_speeds: Option<[f64; 2]>,
    /// G-code by name, which buttons of the live page do.
    pub macros: BTreeMap<String, String>,
    /// The joints' limits.
    pub limits: Limits,
    /// The tool's limits.
    pub motion: ToolLimits,
    /// The control loops.
    pub control: Control,
    /// The control loops of an arm whose controller does not know its belts: those of the rival that reports
    /// compare with.
    pub rigid_control: Control,
    /// The bus.
    pub supply: Supply,
    /// The trip points.
    pub protection: Protection,
    /// The search for the home switches.
    pub homing: HomeSearch,
    /// The tolerances of its parts.
    pub tolerance: ArmTolerance,
    /// Material and contact law of its pins and bearings.
    pub contact: Contact,
    /// Whether it may cross singularities of type 2.
    pub crossing: Crossing,
    /// Numbers of the controller that fit most arms.
    pub advanced: AdvancedSettings,
    /// The loops of joints behind belts; none if the drives are rigid, or if the loops of `control` turn them.
    pub belts: Option<[BeltTuning; 2]>,
}

/// The robot has lengths only, but dynamics need masses.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "robot `{0}` has lengths only: give every [[link]] mass, com and inertia to simulate it or \
     to compute forces"
)]
pub struct MissingMasses(pub String);

impl Robot {
    /// The robot with this name, as for `--robot`: a built-in one, or else a file.
    ///
    /// # Errors
    /// A file that cannot be read, or that [`Robot::parse`] refuses.
    pub fn load(name_or_path: &str) -> Result<Self, FileError> {
        match BuiltIn::find(name_or_path) {
            Some(built_in) => built_in.robot(),
            None => Self::parse(name_or_path, &read(name_or_path)?),
        }
    }

    /// The robot from the text of a file called `file`.
    ///
    /// # Errors
    /// An unknown or missing key, or a value that is not valid, with its line.
    pub fn parse(file: &str, text: &str) -> Result<Self, FileError> {
        let source = Source::new(file, text);
        if slider::is_slider(&source) {
            let reason = "is \"slider\", but a five-bar is needed; only `fivebar query` and \
                          `fivebar accuracy` take sliders";
            return Err(source.refuse(Key::Top("mechanism"), reason));
        }
        let file = source.parse()?;
        check::robot(&source, file).map_err(|refusal| source.error(refusal))
    }

    /// The arm's equations of motion, with the rotors.
    ///
    /// # Errors
    /// The robot has lengths only, no masses.
    pub fn arm(&self) -> Result<&Arm<f64>, MissingMasses> {
        let unknown = || MissingMasses(self.name.clone());
        self.arm.as_ref().ok_or_else(unknown)
    }

    /// The arm with its tolerances, for the analysis of its accuracy.
    pub fn toleranced(&self) -> TolerancedArm<'_> {
        TolerancedArm {
            geometry: &self.geometry,
            arm: self.arm.as_ref(),
            working_mode: self.elbows,
            tolerance: &self.tolerance,
        }
    }
}

/// The text of the robot with this name, as [`Robot::load`] reads it.
///
/// # Errors
/// A file that cannot be read.
pub fn text_of(name_or_path: &str) -> Result<String, FileError> {
    match BuiltIn::find(name_or_path) {
        Some(built_in) => Ok(built_in.text.into()),
        None => read(name_or_path),
    }
}

/// The text of a robot file.
fn read(path: &str) -> Result<String, FileError> {
    text_file::read_text(path.as_ref(), text_file::LARGEST_TOML).map_err(|error| {
        if error.kind() == std::io::ErrorKind::FileTooLarge {
            return FileError::new(path, error);
        }
        let names: Vec<_> = BUILT_IN.iter().map(|robot| robot.name).collect();
        FileError::new(
            path,
            format_args!(
                "no such robot: it is no built-in robot ({}), and as a file: {error}{}",
                names.join(", "),
                did_you_mean(path, names.iter().copied())
            ),
        )
    })
}
