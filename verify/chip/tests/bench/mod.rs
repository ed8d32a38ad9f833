//! The production image on the simulated chip, with the benchtop arm on its pins.

#![allow(dead_code, reason = "each test file uses its own part")]

pub(crate) mod raised;

use fivebar_chip::time::{MICROSECOND, MILLISECOND, Time};
use fivebar_chip::{Arm, Chip, HostLine, Image, Options, Output, SharedArm};
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::protocol::{
    CommandError, ControllerMessage, Decoder, HostCommand, HostMessage, Identity, Reply, Reset,
    Sequence, encode,
};
use fivebar_firmware::{Move, MoveKind, Request, Settings, Status};
use fivebar_kinematics::five_bar::{Joint, Pose};
use fivebar_plant::Mismatch;
use fivebar_plant::Plant;
use fivebar_sim::link::{Client, LinkError};
use nalgebra::Vector2;
use std::cell::RefMut;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// The path of the image, which is built from the sources beside this folder; or in the folder of images that the variable
/// CHIP_IMAGES names, for those that have seeded mistakes.
pub(crate) fn path() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| {
        if let Some(folder) = std::env::var_os("CHIP_IMAGES") {
            return PathBuf::from(folder).join("stm32f405");
        }
        built(&mut Command::new(SCRIPT))
    })
}

/// An image that is built with a variable: `FIVEBAR_CRYSTAL`, for one that no measurement tells from another [MHz], or
/// `FIVEBAR_BOARD`.
pub(crate) fn image_for(variable: &str, value: &str, image: &str) -> Arc<Image> {
    let path = built(Command::new(SCRIPT).arg(image).env(variable, value));
    Arc::new(Image::read(&path).expect("an image"))
}

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/image.sh");

/// The path of the image that the script builds.
fn built(script: &mut Command) -> PathBuf {
    let output = script.output().expect("the script runs");
    let text = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}{errors}");
    PathBuf::from(text.lines().last().expect("a path"))
}

/// The image.
pub(crate) fn image() -> Arc<Image> {
    static IMAGE: OnceLock<Arc<Image>> = OnceLock::new();
    IMAGE
        .get_or_init(|| Arc::new(Image::read(path()).expect("an image")))
        .clone()
}

/// The default robot, read once: a test asks for it and its settings hundreds of times.
pub(crate) fn robot() -> Robot {
    static ROBOT: OnceLock<Robot> = OnceLock::new();
    ROBOT
        .get_or_init(|| Robot::load(BuiltIn::DEFAULT).expect("the default robot"))
        .clone()
}

pub(crate) fn settings() -> Settings {
    static SETTINGS: OnceLock<Settings> = OnceLock::new();
    *SETTINGS.get_or_init(|| robot().settings().expect("the robot has masses"))
}

/// The arm with the tool at a point of the workspace [m].
pub(crate) fn arm_at([x, y]: [f32; 2], wake: Time) -> SharedArm {
    let robot = robot();
    let point = Vector2::new(f64::from(x), f64::from(y));
    let pose = robot
        .geometry
        .inverse(point, robot.elbows)
        .expect("within reach");
    arm_in(&robot, &pose, wake)
}

/// An arm at rest in a pose.
pub(crate) fn arm_in(robot: &Robot, pose: &Pose<f64>, wake: Time) -> SharedArm {
    let plant = Plant::new(
        &robot.plant_parameters().expect("masses"),
        &Mismatch::default(),
        pose,
        7,
    );
    SharedArm::new(Arm::new(plant, wake))
}

/// The arm, 0.03 rad before its home switches.
pub(crate) fn arm(wake: Time) -> SharedArm {
    arm_before_home(&robot(), wake)
}

/// The arm of a robot, 0.03 rad before its home switches.
pub(crate) fn arm_before_home(robot: &Robot, wake: Time) -> SharedArm {
    let settings = robot.settings().expect("masses");
    let before = Joint::ALL.map(|joint| match settings.axes[joint].home_forward {
        true => -0.03,
        false => 0.03,
    });
    let pose = robot.pose_near_home(before).expect("a reachable pose");
    arm_in(robot, &pose, wake)
}

/// A chip with the image, about to get power, and the arm on it.
pub(crate) struct Bench {
    pub(crate) line: HostLine,
    pub(crate) arm: SharedArm,
}

impl Bench {
    pub(crate) fn with(options: Options, stored: Vec<u8>, wake: Time) -> Self {
        Self::of(arm(wake), options, stored)
    }

    pub(crate) fn of(arm: SharedArm, options: Options, stored: Vec<u8>) -> Self {
        Self::on(image(), arm, options, stored)
    }

    pub(crate) fn on(image: Arc<Image>, arm: SharedArm, options: Options, stored: Vec<u8>) -> Self {
        let chip = Chip::new(image, options, stored, Box::new(arm.clone())).expect("an emulator");
        let line = HostLine::new(chip);
        Self { line, arm }
    }

    /// A host opens a session, and waits for replies by the chip's time.
    pub(crate) fn connect(self) -> Driven {
        let Self { line, arm } = self;
        let (client, _) = open(&line).expect("the controller answers");
        Driven { client, line, arm }
    }
}

fn open(line: &HostLine) -> Result<(Client<HostLine>, Identity), LinkError> {
    let time = |line: &HostLine| Duration::from_micros(line.chip().now() / MICROSECOND);
    Client::open_with_clock(line.clone(), time)
}

/// A line from home, a half circle, a dwell and a line back.
pub(crate) fn moves() -> Vec<Move> {
    let point = robot().best_point().expect("a reachable point");
    let [x, y] = point.map(|x| x as f32);
    let feed = 0.3;
    let kinds = [
        MoveKind::Line { to: [x, y], feed },
        MoveKind::Arc {
            to: [x + 0.02, y],
            center: [x + 0.01, y],
            clockwise: true,
            feed,
        },
        MoveKind::Dwell { duration: 0.02 },
        MoveKind::Line { to: [x, y], feed },
    ];
    (1..)
        .zip(kinds)
        .map(|(tag, kind)| Move { tag, tool: 0, kind })
        .collect()
}

/// A built-in job: a gear of twelve teeth with rounded corners.
pub(crate) fn gear() -> Vec<Move> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../host/files/jobs/gear.gcode"
    );
    let scenario = Scenario::of_job(path, robot()).expect("a job file");
    let job = scenario.job().expect("a job");
    scenario.moves(&job).expect("a job without M780")
}

/// A host connected to a chip.
pub(crate) struct Driven {
    pub(crate) client: Client<HostLine>,
    pub(crate) line: HostLine,
    pub(crate) arm: SharedArm,
}

impl Bench {
    /// The settings are in use; nothing is stored, homed or armed.
    pub(crate) fn ready(self) -> Driven {
        self.ready_with(|_| ())
    }

    /// As [`Bench::ready`], with changed settings.
    pub(crate) fn ready_with(self, change: impl FnOnce(&mut Settings)) -> Driven {
        let mut settings = settings();
        change(&mut settings);
        self.ready_as(&settings)
    }

    /// As [`Bench::ready`], with these settings.
    pub(crate) fn ready_as(self, settings: &Settings) -> Driven {
        let mut driven = self.connect();
        if driven.status().fault.is_some() {
            driven.request(Request::ClearFault).expect("cleared");
        }
        let client = &mut driven.client;
        let applied = client.write_settings(settings).expect("a line");
        applied.expect("the settings are applied");
        driven
    }
}

impl Driven {
    pub(crate) fn new() -> Self {
        Bench::with(Options::default(), Vec::new(), 0).ready()
    }

    pub(crate) fn chip(&self) -> RefMut<'_, Chip> {
        self.line.chip()
    }

    pub(crate) fn run(&mut self, time: Time) {
        let ran = self.chip().run(time);
        if let Err(report) = ran {
            panic!("{report}");
        }
    }

    pub(crate) fn request(&mut self, request: Request) -> Result<(), CommandError> {
        let command = HostCommand::Request(request);
        self.client
            .command(command)
            .expect("the controller answers")
    }

    pub(crate) fn status(&mut self) -> Status {
        self.client.status().expect("the controller answers").0
    }

    /// Tells the controller where the arm is, and arms it; the angles that it was told.
    pub(crate) fn arm(&mut self) -> [f32; 2] {
        let angles = Joint::ALL.map(|joint| self.arm.get().plant().angle(joint) as f32);
        self.request(Request::SetAngles(angles)).expect("angles");
        self.request(Request::Arm).expect("armed");
        self.run(5 * MILLISECOND);
        let acting = *self.arm.get().acting();
        assert_eq!((acting.enable, acting.brake), ([true; 2], false));
        angles
    }

    /// Whether both the timer's outputs and the sleep pins keep the bridges off, and the brake
    /// is engaged.
    pub(crate) fn is_off_twice(&self) -> bool {
        let arm = self.arm.get();
        let outputs = arm.outputs();
        let by_timer = |output: &Output| !matches!(output, Output::Pwm { .. });
        let asleep = |level: &Option<bool>| *level != Some(true);
        let braked = outputs.brake != Some(true);
        outputs.pwm.iter().all(by_timer) && outputs.sleep.iter().all(asleep) && braked
    }

    /// Whether no bridge drives its motor.
    pub(crate) fn is_off(&self) -> bool {
        self.arm.get().acting().enable == [false; 2]
    }

    /// The host begins a new session, as after a reset: why the controller started.
    pub(crate) fn reconnect(&mut self) -> Reset {
        let opened = open(&self.line);
        let (client, identity) = opened.expect("the controller answers");
        self.client = client;
        identity.reset
    }
}

/// Flash that some other program has used, in which no settings are.
pub(crate) fn used_flash() -> Vec<u8> {
    (0..512 * 1024_u32)
        .map(|at| (at.wrapping_mul(2_654_435_761) >> 24) as u8)
        .collect()
}

/// Stores the settings in use.
pub(crate) fn save(driven: &mut Driven) -> Reply {
    driven
        .client
        .call(HostCommand::SaveSettings)
        .expect("the controller answers")
}

/// Sends a command once, with any sequence number, and lets the chip run for 20 ms.
pub(crate) fn tell(driven: &Driven, sequence: u16, command: HostCommand) {
    let message = HostMessage {
        sequence: Sequence(sequence),
        command,
    };
    let frame = encode(&message).expect("a frame");
    let mut chip = driven.chip();
    chip.send(&frame);
    chip.run(20 * MILLISECOND).expect("no violation");
}

/// The messages that have arrived since the last look.
pub(crate) fn hear(driven: &Driven) -> Vec<ControllerMessage> {
    let mut decoder = Decoder::<ControllerMessage>::new();
    let bytes = driven.chip().receive(usize::MAX).into_iter();
    bytes.filter_map(|byte| decoder.feed(byte)?.ok()).collect()
}

/// As [`tell`]: the replies that come.
pub(crate) fn say(driven: &Driven, sequence: u16, command: HostCommand) -> Vec<Reply> {
    tell(driven, sequence, command);
    let replies = hear(driven)
        .into_iter()
        .filter_map(|message| match message {
            ControllerMessage::Reply { reply, .. } => Some(reply),
            ControllerMessage::Telemetry(_) | ControllerMessage::Stream(_) => None,
        });
    replies.collect()
}
