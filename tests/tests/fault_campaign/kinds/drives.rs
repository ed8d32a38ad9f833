//! The kinds of drive of the campaign, each with its arm and its job.

use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::safety::DriveKind;
use fivebar_sim::simulation::Simulate;

/// A kind of drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Drive {
    Brushed,
    Stepper,
    StepperWithEncoder,
    Odrive,
    Mit,
    HobbyServo,
}

impl Drive {
    pub(crate) const ALL: [Self; 6] = [
        Self::Brushed,
        Self::Stepper,
        Self::StepperWithEncoder,
        Self::Odrive,
        Self::Mit,
        Self::HobbyServo,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Odrive => "CAN (ODrive)",
            Self::Mit => "CAN (MIT)",
            other => other.of_controller().name(),
        }
    }

    /// What the controller knows of it.
    pub(crate) fn of_controller(self) -> DriveKind {
        match self {
            Self::Brushed => DriveKind::Brushed,
            Self::Stepper => DriveKind::Stepper,
            Self::StepperWithEncoder => DriveKind::StepperWithEncoder,
            Self::Odrive | Self::Mit => DriveKind::CanTorque,
            Self::HobbyServo => DriveKind::HobbyServo,
        }
    }

    pub(crate) fn is_on_bus(self) -> bool {
        matches!(self, Self::Odrive | Self::Mit)
    }

    pub(crate) fn has_steps(self) -> bool {
        matches!(self, Self::Stepper | Self::StepperWithEncoder)
    }

    /// Whether a joint's place is measured.
    pub(crate) fn is_measured(self) -> bool {
        !matches!(self, Self::Stepper | Self::HobbyServo)
    }

    /// A built-in arm with such drives and with holding brakes.
    fn robot(self) -> Robot {
        let text = self.robot_file();
        Robot::parse(self.name(), &text).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Its file.
    pub(crate) fn robot_file(self) -> String {
        const STEPPER: &str = "kind = \"stepper\"";
        const SERVO: &str = "kind = \"servo\"\npulse_range";
        const COUNTS: &str = "encoder_counts = 16384";
        const MIT: &str =
            "protocol = \"mit\"\nposition_range = 12.5\nvelocity_range = 640.0\ntorque_range = 2.0";
        let brake =
            |text: &str, key: &str| text.replace(key, &format!("brake_torque = 0.5\n{key}"));
        let name = match self {
            Self::Brushed => "benchtop_belt",
            Self::Stepper | Self::StepperWithEncoder => "benchtop_stepper",
            Self::Odrive | Self::Mit => "leg",
            Self::HobbyServo => "classroom_servo",
        };
        let text = BuiltIn::find(name).expect("built in").text;
        match self {
            Self::Brushed => brake(text, COUNTS),
            Self::Stepper => brake(text, STEPPER),
            Self::StepperWithEncoder => {
                brake(text, STEPPER).replace(STEPPER, "kind = \"stepper\"\nencoder_counts = 4000")
            }
            Self::Odrive => text.to_owned(),
            Self::Mit => text.replace("protocol = \"odrive\"", MIT),
            Self::HobbyServo => brake(text, SERVO),
        }
    }
}

/// Lines of the job of [`job`].
pub(crate) const APPROACH: u32 = 2;
pub(crate) const RESTS: u32 = 4;
pub(crate) const DRAWS_SLOWLY: [u32; 2] = [5, 8];
pub(crate) const DRAWS_FAST: [u32; 2] = [9, 12];

/// A square that is drawn at half of the greatest speed, then at that speed [m/s].
fn job(fastest: f64) -> String {
    let [slow, fast] = [0.5, 1.0].map(|share| share * fastest * 60e3);
    format!(
        "G21 G90 M5\nG0 X-6 Y-6 F{fast:.0}\nM3\nG4 S0.3\n\
         G1 X6 F{slow:.0}\nY6\nX-6\nY-6\nX6 F{fast:.0}\nY6\nX-6\nY-6\nM5\n"
    )
}

/// The arm and its job.
pub(crate) fn scenario(drive: Drive) -> Scenario {
    let robot = drive.robot();
    let text = job(robot.motion.max_speed);
    let mut scenario = Scenario::new(drive.name(), robot, "square.gcode", text);
    scenario
        .fit()
        .unwrap_or_else(|error| panic!("{drive:?}: {error}"));
    scenario
}
