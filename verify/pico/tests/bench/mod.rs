//! The images on the simulated Pico 2, and the loop in this process to compare with.

#![allow(dead_code, reason = "each file of tests uses a part of it")]

use fivebar_files::robot::Robot;
use fivebar_firmware::controller::{ArmController, Request};
use fivebar_firmware::drives::{StepDrives, StepSample};
use fivebar_firmware::planner::Planner;
use fivebar_firmware::protocol::{
    CommandError, HostCommand, HostMessage, Identity, Reply, Sequence, encode,
};
use fivebar_firmware::safety::State;
use fivebar_firmware::{ArmSample, Move, MoveKind, Settings, Status};
use fivebar_pico::{Chip, HZ, HostLine, Image, Pulse};
use fivebar_sim::link::Client;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Cycles of a tick.
pub(crate) const PERIOD: u64 = HZ / 10_000;

/// More ticks than the job takes.
const JOB_TICKS: u64 = 30_000;

/// The folder of the images, which are built from the sources beside this folder, or the one that PICO_IMAGES names.
fn folder() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| {
        if let Some(path) = std::env::var_os("PICO_IMAGES") {
            return path.into();
        }
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scripts/pico.sh");
        // The target folder of this crate is not that of the image.
        let mut build = Command::new(script);
        let output = build.arg("image").env_remove("CARGO_TARGET_DIR").output();
        let output = output.expect("the script runs");
        let text = String::from_utf8_lossy(&output.stdout);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{text}{errors}");
        PathBuf::from(text.lines().last().expect("a path"))
    })
}

/// The path of an image.
pub(crate) fn path(image: &str) -> PathBuf {
    folder().join(image)
}

/// A host connected to a chip, whose settings are in use.
pub(crate) struct Bench {
    pub(crate) client: Client<HostLine>,
    pub(crate) line: HostLine,
    pub(crate) identity: Identity,
    pub(crate) robot: Robot,
    pub(crate) settings: Settings,
}

impl Bench {
    /// The image for hobby servos.
    pub(crate) fn new() -> Self {
        Self::of("rp2350_servo", "classroom_servo")
    }

    /// An image with the settings of a robot.
    pub(crate) fn of(image: &str, robot: &str) -> Self {
        let robot = Robot::load(robot).expect("a built-in robot");
        let settings = robot.settings().expect("settings");
        Self::with(image, robot, settings)
    }

    /// An image with these settings.
    pub(crate) fn with(image: &str, robot: Robot, settings: Settings) -> Self {
        Self::on(HostLine::new(started(image)), robot, settings)
    }

    /// The same over USB.
    pub(crate) fn over_usb(image: &str, robot: &str) -> Self {
        let robot = Robot::load(robot).expect("a built-in robot");
        let settings = robot.settings().expect("settings");
        let line = HostLine::new(started(image)).over_usb();
        plug(&mut line.chip());
        Self::on(line, robot, settings)
    }

    fn on(line: HostLine, robot: Robot, settings: Settings) -> Self {
        let (mut client, identity) = open(&line);
        let applied = client.write_settings(&settings).expect("a line");
        applied.expect("the settings are applied");
        Self {
            client,
            line,
            identity,
            robot,
            settings,
        }
    }

    /// Power comes on with this flash, and the host begins a session.
    pub(crate) fn start_with(&mut self, flash: &[u8]) -> Identity {
        self.line.chip().flash().copy_from_slice(flash);
        self.line.chip().power_cycle();
        self.line.chip().run(HZ / 100).expect("it starts");
        self.connect_again()
    }

    /// The host begins a new session, as after a reset.
    pub(crate) fn connect_again(&mut self) -> Identity {
        let (client, identity) = open(&self.line);
        self.client = client;
        identity
    }

    pub(crate) fn request(&mut self, request: Request) -> Result<(), CommandError> {
        let command = HostCommand::Request(request);
        self.client.command(command).expect("it answers")
    }

    pub(crate) fn status(&mut self) -> Status {
        self.client.status().expect("it answers").0
    }

    pub(crate) fn save(&mut self) {
        let saved = self.client.call(HostCommand::SaveSettings);
        assert_eq!(saved.expect("it answers"), Reply::Done);
    }

    /// The servos have pulses.
    pub(crate) fn power(&mut self) {
        self.request(Request::Home).expect("accepted");
        while self.status().state == State::Homing {}
        self.request(Request::Arm).expect("armed");
        while self.status().state != State::Armed {}
        // A pulse has begun.
        self.line.chip().run(HZ / 1000).expect("it runs");
    }

    /// Hands over a job, which begins with a dwell, and waits for its end. The drives have power.
    pub(crate) fn draw(&mut self, job: &[Move]) {
        for next in job {
            let reply = self.client.call(HostCommand::Move(*next));
            assert!(matches!(reply, Ok(Reply::Taken { .. })), "{reply:?}");
        }
        for _ in 0..JOB_TICKS / 500 {
            let status = self.status();
            assert_eq!((status.fault, status.missed_ticks), (None, 0));
            self.line.chip().run(500 * PERIOD).expect("it runs");
        }
        assert_eq!(self.status().state, State::Armed);
    }
}

/// A chip whose image has started.
fn started(image: &str) -> Chip {
    let image = Image::read(&path(image)).expect("an image");
    let mut chip = Chip::new(&image);
    chip.run(HZ / 100).expect("it starts");
    chip
}

/// Plugs the USB cable in, and waits until the host has opened the serial line.
pub(crate) fn plug(chip: &mut Chip) {
    chip.usb().plug();
    for _ in 0..100 {
        chip.run(HZ / 1000).expect("it runs");
        let host = chip.usb();
        if host.is_open() {
            return;
        }
        assert_eq!(host.failure, None);
    }
    panic!("the host finds no serial line within 0.1 s");
}

pub(crate) fn open(line: &HostLine) -> (Client<HostLine>, Identity) {
    Client::open_with_clock(line.clone(), HostLine::time).expect("it answers")
}

/// A dwell, a line, a half circle and a line back with this speed [m/s]: no more than the queue holds.
pub(crate) fn commands(robot: &Robot, feed: f32) -> Vec<Move> {
    let [x, y] = robot
        .best_point()
        .expect("a reachable point")
        .map(|x| x as f32);
    let kinds = [
        MoveKind::Dwell { duration: 0.2 },
        MoveKind::Line { to: [x, y], feed },
        MoveKind::Arc {
            to: [x + 0.01, y],
            center: [x + 0.005, y],
            clockwise: true,
            feed,
        },
        MoveKind::Line { to: [x, y], feed },
    ];
    (1..)
        .zip(kinds)
        .map(|(tag, kind)| Move { tag, tool: 0, kind })
        .collect()
}

/// The units of both pulses after each tick of the same job in this process, by the controller of the desktop's loop.
pub(crate) fn desktop(settings: &Settings, job: &[Move]) -> Vec<[i32; 2]> {
    let mut made = [0_i32; 2];
    let mut units = Vec::new();
    play(settings, job, Request::Home, |controller| {
        let command = controller.tick(&sample(made));
        for (made, steps) in made.iter_mut().zip(command.drives.steps) {
            *made += steps;
        }
        units.push(made);
    });
    units
}

/// What a controller of steps senses that has made these.
pub(crate) fn sample(made: [i32; 2]) -> ArmSample<StepSample> {
    let drives = StepSample {
        steps: made,
        ..StepSample::default()
    };
    ArmSample {
        counts: made,
        drives,
        ..ArmSample::default()
    }
}

/// Plays a job in this process: `tick` is each tick of the controller.
pub(crate) fn play(
    settings: &Settings,
    job: &[Move],
    homing: Request,
    mut tick: impl FnMut(&mut ArmController<StepDrives>),
) {
    let settings = settings.check().expect("valid settings");
    let mut controller = ArmController::<StepDrives>::new(&settings);
    let mut planner = Planner::new(&settings);
    let mut tick = |controller: &mut ArmController<StepDrives>| {
        controller.feed_host_timeout();
        tick(controller);
    };
    tick(&mut controller);
    controller.request(homing).expect("accepted");
    while !controller.status().homed {
        tick(&mut controller);
    }
    // Homing arms an arm that only power keeps where it is.
    for _ in 0..3000 {
        tick(&mut controller);
    }
    if controller.state() != State::Armed {
        controller.request(Request::Arm).expect("armed");
        for _ in 0..1000 {
            tick(&mut controller);
        }
    }
    for next in job {
        planner.push(&mut controller, next).expect("a valid move");
    }
    for _ in 0..JOB_TICKS {
        planner.run(&mut controller);
        tick(&mut controller);
    }
    assert_eq!(controller.state(), State::Armed, "the job has ended");
}

/// The pulses of a joint.
pub(crate) fn of(pulses: &[Pulse], joint: usize) -> Vec<Pulse> {
    let of_joint = |pulse: &&Pulse| pulse.joint == joint;
    pulses.iter().filter(of_joint).copied().collect()
}

/// The bytes of a command.
pub(crate) fn frame(sequence: u16, command: HostCommand) -> Vec<u8> {
    let sequence = Sequence(sequence);
    let message = HostMessage { sequence, command };
    encode(&message).expect("a frame").to_vec()
}
