//! Robots: read from TOML, checked once, turned into what the models and the controller
//! take.

mod builtin;
mod check;
mod contact;
mod draft;
mod file;
mod fit;
mod home;
mod settings;
mod slider;
mod template;
mod tolerance;
mod value;
mod workspace;

pub use builtin::{BUILT_IN, BuiltIn};
pub use contact::{Contact, Restitution};
pub use draft::{Draft, Motor, Unfit};
pub use file::{Actuator, Control, Limits, Motion, Protection, Supply, Tool};
pub(crate) use fit::in_words_of_its_file;
pub use home::NoHome;
pub use slider::{Mechanism, SliderRobot, SliderTolerance};
pub use workspace::NoWorkspace;

use crate::input::source::{FileError, Key, Source};
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{Geometry, WorkingMode};

/// A robot as its file describes it, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// Its name.
    pub name: String,
    /// l1…l4 and the base, proven able to close.
    pub geometry: Geometry<f64>,
    /// Its equations of motion, rotors included; none where the masses are not known.
    arm: Option<Arm<f64>>,
    /// Which way the elbows of the legs A–B–C and E–D–C turn, as the file says: the working
    /// mode of C. That of the tool: [`Robot::working_mode`].
    pub elbows: WorkingMode,
    /// θ1, θ4 at the home switches [rad].
    pub home: [f64; 2],
    /// The drives of joint 1 and joint 4; without them, ideal torque sources.
    pub actuators: Option<[Actuator; 2]>,
    /// The tool on link 2.
    pub tool: Tool,
    /// The joints' limits.
    pub limits: Limits,
    /// The tool's limits.
    pub motion: Motion,
    /// The loops.
    pub control: Control,
    /// The bus.
    pub supply: Supply,
    /// The trip points.
    pub protection: Protection,
    /// How exact its parts are.
    pub tolerance: Tolerance,
    /// What its pins and bearings are made of.
    pub contact: Contact,
}

/// `[tolerance]`: how exact the parts are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerance {
    /// Standard deviation of l1…l4 and the base [m].
    pub length_sd: [f64; 5],
    /// Standard deviation of θ1 and θ4 [rad].
    pub input_sd: [f64; 2],
    /// Greatest error of θ1 and θ4 [rad].
    pub input_max: [f64; 2],
    /// Radial clearance of the joints A, B, C, D, E [m].
    pub clearance_radius: [f64; 5],
}

/// A robot whose masses are not known was asked for what needs them.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "robot `{0}` is known by its lengths alone: give every [[link]] mass, com and inertia \
     to simulate it or to ask for forces"
)]
pub struct KinematicsOnly(pub String);

impl Robot {
    /// The robot that `--robot` names: a built-in one, or else a file.
    ///
    /// # Errors
    /// A file that cannot be read, or that [`Robot::parse`] refuses.
    pub fn load(name_or_path: &str) -> Result<Self, FileError> {
        match BuiltIn::find(name_or_path) {
            Some(built_in) => built_in.robot(),
            None => Self::parse(name_or_path, &read(name_or_path)?),
        }
    }

    /// The robot described by the text of a file called `file`.
    ///
    /// # Errors
    /// An unknown or missing key, or a value that makes no sense, with its line.
    pub fn parse(file: &str, text: &str) -> Result<Self, FileError> {
        let source = Source { file, text };
        if slider::is_one(source) {
            let reason = "is \"slider\", and this takes a five-bar; `fivebar query` takes either";
            return Err(source.refuse(Key::Top("mechanism"), reason));
        }
        check::robot(source)
    }

    /// The arm's equations of motion, rotors included.
    ///
    /// # Errors
    /// A robot known by its lengths alone.
    pub fn arm(&self) -> Result<&Arm<f64>, KinematicsOnly> {
        let unknown = || KinematicsOnly(self.name.clone());
        self.arm.as_ref().ok_or_else(unknown)
    }
}

/// The text of a robot file.
fn read(path: &str) -> Result<String, FileError> {
    std::fs::read_to_string(path).map_err(|error| {
        let names: Vec<_> = BUILT_IN.iter().map(|robot| robot.name).collect();
        FileError {
            file: path.into(),
            line: None,
            reason: format!(
                "no such robot: not a built-in one ({}), and as a file: {error}",
                names.join(", ")
            ),
        }
    })
}
