//! The three images as the suite sees them: what means power, a push and a released brake, and how each is brought into
//! motion.

use super::bench;
use super::recorder::{Recorder, SharedRecord, StepDrivers};
use fivebar_chip::time::{MICROSECOND, MILLISECOND, Time};
use fivebar_chip::{
    CanArm, Chip, DriveKind, HostLine, Image, Options, Output, Outputs, Pin, SharedArm,
    SharedCanArm, Wiring,
};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::Settings;
use fivebar_firmware::drives::can::{BusDrives, odrive};
use fivebar_firmware::protocol::{Board, Identity};
use fivebar_firmware::settings::{BeltSettings, BrakeSettings, ToolOutputSettings};
use fivebar_sim::link::Client;
use fivebar_sim::simulation::{Simulate, SimulatedDrives};
use std::cell::RefMut;
use std::sync::{Arc, Mutex, OnceLock};
use std::time::Duration;

/// An image, and what holds for it alone.
pub(crate) struct Description {
    /// Its file.
    pub(crate) file: &'static str,
    pub(crate) drives: DriveKind,
    board: Board,
    robot: &'static str,
    pub(crate) tick: Time,
    /// From the order of power until the drives are awake, at least.
    pub(crate) wake: Time,
    /// From the end of the program, by whatever cause, until no joint has power.
    pub(crate) off_within: Time,
    /// The levels of PB14 and PB15 without power; none where no pin gives it.
    pub(crate) off_level: Option<bool>,
    /// Inputs of the emergency stop, and whether a timer's outputs go off with each at once.
    pub(crate) stops: &'static [Pin],
    pub(crate) stops_by_timer: bool,
    /// The interrupt of the tick.
    pub(crate) tick_interrupt: u32,
    /// Share of the greatest speed of a move that lasts for half a second or more.
    pub(crate) speed: f32,
}

pub(crate) static BRUSHED: Description = Description {
    file: "stm32f405",
    drives: DriveKind::Brushed,
    board: Board::Stm32f405,
    robot: "benchtop",
    tick: 100 * MICROSECOND,
    wake: 1500 * MICROSECOND,
    off_within: 10 * MICROSECOND,
    off_level: Some(false),
    stops: &[Pin(1, 12)],
    stops_by_timer: true,
    tick_interrupt: 18,
    speed: 0.02,
};

pub(crate) static STEPPERS: Description = Description {
    file: "stm32f405_stepper",
    drives: DriveKind::Steppers,
    board: Board::Stm32f405Stepper,
    robot: "benchtop_stepper",
    tick: 100 * MICROSECOND,
    wake: 200 * MILLISECOND,
    off_within: 10 * MICROSECOND,
    off_level: Some(true),
    stops: &[Pin(1, 12), Pin(0, 6)],
    stops_by_timer: true,
    tick_interrupt: 30,
    speed: 0.02,
};

pub(crate) static CAN: Description = Description {
    file: "stm32f405_can",
    drives: DriveKind::OnBus,
    board: Board::Stm32f405Can,
    robot: "leg",
    tick: MILLISECOND,
    wake: 50 * MILLISECOND,
    off_within: 5 * MILLISECOND,
    off_level: None,
    stops: &[Pin(1, 12)],
    stops_by_timer: false,
    tick_interrupt: 50,
    speed: 0.02,
};

/// What reaches a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Signal {
    /// Its drive is given power, or it is taken away.
    Power(bool),
    /// A duty, a step to or fro, or a torque [1, ±1, N·m].
    Push(f64),
}

/// A signal, when it came and for which joint, 0 or 1.
pub(crate) type Event = (Time, usize, Signal);

/// The arm on the pins.
pub(crate) enum Arm {
    Brushed(SharedArm),
    Steppers,
    Bus(SharedCanArm),
}

/// What is made once for each image, by the image's file.
pub(crate) type OfImages<T> = OnceLock<Mutex<Vec<(&'static str, T)>>>;

/// The image on a chip that is about to get power.
pub(crate) struct Unit {
    pub(crate) image: &'static Description,
    pub(crate) line: HostLine,
    pub(crate) record: SharedRecord,
    pub(crate) arm: Arm,
}

impl Description {
    pub(crate) fn program(&self) -> Arc<Image> {
        static PROGRAMS: OfImages<Arc<Image>> = OnceLock::new();
        let mut programs = PROGRAMS
            .get_or_init(Mutex::default)
            .lock()
            .expect("no panic");
        if let Some((_, program)) = programs.iter().find(|it| it.0 == self.file) {
            return program.clone();
        }
        let path = bench::path().with_file_name(self.file);
        let program = Arc::new(Image::read(&path).expect("an image"));
        programs.push((self.file, program.clone()));
        program
    }

    /// The robot with brakes that need 20 ms, a tool, and motors that no load turns.
    pub(crate) fn settings(&self) -> Settings {
        let robot = Robot::load(self.robot).expect("a built-in robot");
        let mut settings = robot.settings().expect("settings");
        settings.brake = BrakeSettings {
            engage_time: 0.02,
            release_time: 0.02,
        };
        settings.tool_output = ToolOutputSettings::Switch {
            active_low: false,
            down_time: 0.0,
            up_time: 0.0,
        };
        if self.drives == DriveKind::Steppers {
            settings.belts = [BeltSettings::RIGID; 2];
        }
        settings
    }

    fn arm(&self) -> (Arm, Box<dyn Wiring>) {
        match self.drives {
            DriveKind::Brushed => {
                let arm = bench::arm(0);
                (Arm::Brushed(arm.clone()), Box::new(arm))
            }
            DriveKind::Steppers => (Arm::Steppers, Box::new(StepDrivers)),
            DriveKind::OnBus => {
                let robot = Robot::load(self.robot).expect("a built-in robot");
                let mut scenario = Scenario::demonstration(robot);
                scenario.fit().expect("it fits");
                let plant = BusDrives::arm(&scenario).expect("an arm");
                let arm = SharedCanArm::new(CanArm::new(plant));
                (Arm::Bus(arm.clone()), Box::new(arm))
            }
        }
    }

    /// A chip with this image and these contents of its settings' sectors.
    pub(crate) fn unit(&'static self, stored: Vec<u8>) -> Unit {
        let record = SharedRecord::default();
        let (arm, inner) = self.arm();
        let wiring = Recorder {
            record: record.clone(),
            inner,
        };
        let options = Options {
            drives: self.drives,
            ..Options::default()
        };
        let chip = Chip::new(self.program(), options, stored, Box::new(wiring));
        Unit {
            image: self,
            line: HostLine::new(chip.expect("an emulator")),
            record,
            arm,
        }
    }
}

impl Unit {
    pub(crate) fn chip(&self) -> RefMut<'_, Chip> {
        self.line.chip()
    }

    pub(crate) fn now(&self) -> Time {
        self.chip().now()
    }

    pub(crate) fn run(&self, time: Time) {
        let ran = self.chip().run(time);
        if let Err(report) = ran {
            panic!("{report}");
        }
    }

    /// A host opens a session.
    pub(crate) fn open(&self) -> (Client<HostLine>, Identity) {
        let time = |line: &HostLine| Duration::from_micros(line.chip().now() / MICROSECOND);
        let opened = Client::open_with_clock(self.line.clone(), time);
        let (client, identity) = opened.expect("the controller answers");
        assert_eq!(identity.board, self.image.board);
        (client, identity)
    }

    /// What the chip drives.
    pub(crate) fn outputs(&self) -> Outputs {
        let record = self.record.get();
        record.changes.last().map_or(Outputs::RELEASED, |it| it.1)
    }

    /// Changes of the brake's pin from a time on: whether it is released.
    pub(crate) fn brake(&self, from: Time) -> Vec<(Time, bool)> {
        let mut released = false;
        let mut found = Vec::new();
        for (at, outputs) in &self.record.get().changes {
            let now = outputs.brake == Some(true);
            if now != released && *at >= from {
                found.push((*at, now));
            }
            released = now;
        }
        found
    }

    /// What reached the joints from a time on.
    pub(crate) fn events(&self, from: Time) -> Vec<Event> {
        let mut events = match &self.arm {
            Arm::Bus(arm) => frames(arm),
            Arm::Brushed(_) | Arm::Steppers => self.pins(),
        };
        events.retain(|event| event.0 >= from);
        events
    }

    fn pins(&self) -> Vec<Event> {
        let mut events = Vec::new();
        let mut before = Outputs::RELEASED;
        for &(at, outputs) in &self.record.get().changes {
            for joint in 0..2 {
                let power = |outputs: &Outputs| match self.image.off_level {
                    Some(off) => outputs.sleep[joint] == Some(!off),
                    None => false,
                };
                if power(&before) != power(&outputs) {
                    events.push((at, joint, Signal::Power(power(&outputs))));
                }
                let push = match self.image.drives {
                    DriveKind::Steppers => step(&before, &outputs, joint),
                    _ => (duty(&before, joint) != duty(&outputs, joint))
                        .then(|| duty(&outputs, joint)),
                };
                events.extend(push.map(|push| (at, joint, Signal::Push(push))));
            }
            before = outputs;
        }
        events
    }

    /// Whether each joint's drive can push now.
    pub(crate) fn is_powered(&self) -> [bool; 2] {
        let now = self.now();
        match &self.arm {
            Arm::Bus(arm) => {
                let mut arm = arm.get();
                arm.follow(now);
                arm.plant().torque().map(|torque| torque != 0.0)
            }
            Arm::Brushed(_) | Arm::Steppers => {
                let sleep = self.outputs().sleep;
                sleep.map(|level| level.is_some() && level != self.image.off_level)
            }
        }
    }
}

/// The step of a change, if it is one.
fn step(before: &Outputs, after: &Outputs, joint: usize) -> Option<f64> {
    let rises = before.steps[joint] != Some(true) && after.steps[joint] == Some(true);
    let forwards = after.direction[joint] == Some(true);
    rises.then_some(if forwards { 1.0 } else { -1.0 })
}

/// The duty that a bridge's inputs have.
fn duty(outputs: &Outputs, joint: usize) -> f64 {
    let share = |output: Output| match output {
        Output::Released => 0.0,
        Output::Idle(level) => f64::from(u8::from(level)),
        Output::Pwm { high, period } => f64::from(high) / f64::from(period),
    };
    share(outputs.pwm[2 * joint]) - share(outputs.pwm[2 * joint + 1])
}

/// What the chip's frames say to the leg's drives.
fn frames(arm: &SharedCanArm) -> Vec<Event> {
    let mut events = Vec::new();
    let arm = arm.get();
    for it in arm.frames.iter().filter(|it| it.is_own) {
        let (joint, message) = (
            (it.frame.id >> 5).wrapping_sub(1) as usize,
            it.frame.id & 0x1F,
        );
        let Some(data) = it.frame.data.filter(|_| joint < 2) else {
            continue;
        };
        match message {
            0x07 => events.push((it.at, joint, Signal::Power(data[0] == odrive::CLOSED_LOOP))),
            0x0C => {
                let torque = i16::from_le_bytes([data[6], data[7]]);
                events.push((it.at, joint, Signal::Push(f64::from(torque) * 1e-3)));
            }
            _ => {}
        }
    }
    events
}
