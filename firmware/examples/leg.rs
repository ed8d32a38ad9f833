//! A leg on two torque drives: homed, armed and moved without one ADC code or duty.
//!
//! The drives close their own current loops. They answer with the torque that they give and with the counts of
//! their encoders, both some ticks old, as over a bus. The leg hangs below its hips; gravity pulls it down.
//!
//! `cargo run --example leg`

use fivebar_firmware::controller::{ArmController, Request};
use fivebar_firmware::drives::{DriveHealth, TorqueDrives, TorqueSample, TorqueSetPoint};
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::{CheckedSettings, HomeReference, HomingMethod};
use fivebar_firmware::{ArmCommand, ArmSample, Move, MoveKind, Planner, Settings};
use std::collections::VecDeque;
use std::error::Error;
use std::f32::consts::TAU;

/// Age of the drives' answers [ticks].
const AGE: usize = 5;
/// Angles of the cranks at the start [rad]; the encoders are absolute.
const START: [f32; 2] = [2.2, 0.9];

/// Two drives, each with a constant inertia at its joint.
struct Drives {
    settings: CheckedSettings,
    /// Angle [rad], velocity [rad/s] and torque [N·m] of each joint.
    joints: [[f32; 3]; 2],
    /// Answers on their way, the newest last.
    answers: VecDeque<ArmSample<TorqueSample>>,
}

impl Drives {
    fn new(settings: CheckedSettings) -> Self {
        Self {
            settings,
            joints: START.map(|angle| [angle, 0.0, 0.0]),
            answers: VecDeque::new(),
        }
    }

    /// The answers that have arrived.
    fn sample(&mut self) -> ArmSample<TorqueSample> {
        let mut now = ArmSample::<TorqueSample>::default();
        for (i, axis) in self.settings.axes.iter().enumerate() {
            let [angle, _, torque] = self.joints[i];
            let turns = (angle - axis.home_angle) / TAU * axis.gear_ratio;
            now.counts[i] = (turns * axis.encoder_counts as f32).round() as i32;
            now.drives.torque[i] = torque;
        }
        self.answers.push_back(now);
        let age = (self.answers.len() - 1).min(AGE);
        let mut sample = match self.answers.len() > AGE {
            true => self.answers.pop_front().expect("an answer"),
            false => self.answers[0],
        };
        sample.drives.age = [age as u16; 2];
        sample.drives.health = [DriveHealth::Drives; 2];
        sample
    }

    fn apply(&mut self, command: &ArmCommand<TorqueSetPoint>) {
        let rate = self.settings.control.tick_rate;
        let inertia = self.settings.nominal_inertia();
        for (i, joint) in self.joints.iter_mut().enumerate() {
            let [angle, velocity, torque] = joint;
            *torque = f32::from(command.enable[i]) * command.drives.torque[i];
            *velocity += *torque / inertia[i] / rate;
            *angle += *velocity / rate;
        }
    }
}

/// The leg, its controller and what plans its motion.
struct Leg {
    drives: Drives,
    controller: ArmController<TorqueDrives>,
    planner: Planner,
}

impl Leg {
    /// Ticks until the leg is in this state, and its path is over.
    fn run_to(&mut self, state: State) -> u32 {
        for ticks in 1..20_000 {
            let sample = self.drives.sample();
            let command = self.controller.tick(&sample);
            self.drives.apply(&command);
            // A session would do this for each frame of the host.
            self.controller.feed_host_timeout();
            self.planner.run(&mut self.controller);
            if self.planner.is_empty() && self.controller.state() == state {
                return ticks;
            }
        }
        panic!("no {state:?}: {:?}", self.controller.status().fault);
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut settings = Settings::BENCHTOP;
    settings.home_reference = HomeReference {
        method: HomingMethod::Absolute,
        samples: 1,
    };
    for axis in &mut settings.axes {
        axis.encoder_latency = AGE as f32 / settings.control.tick_rate;
        // Their current loops have no lag.
        axis.inductance = 1e-5 * axis.resistance;
    }
    let settings = settings.check()?;
    let mut leg = Leg {
        drives: Drives::new(settings),
        controller: ArmController::new(&settings),
        planner: Planner::new(&settings),
    };
    leg.run_to(State::Stopped);
    leg.controller.request(Request::Home)?;
    leg.run_to(State::Stopped);
    leg.controller.request(Request::Arm)?;
    let to = [0.06, 0.19]; // m
    let step = Move {
        tag: 1,
        tool: 0,
        kind: MoveKind::Line { to, feed: 0.1 }, // m/s
    };
    leg.planner.push(&mut leg.controller, &step)?;
    let ticks = leg.run_to(State::Armed);
    let [x, y] = leg.controller.status().tool.ok_or("no position")?;
    println!("after {ticks} ticks of 0.1 ms the foot is at ({x:.6}, {y:.6}) m");
    assert!((x - to[0]).hypot(y - to[1]) < 0.2e-3);
    Ok(())
}

#[test]
fn a_leg_is_homed_armed_and_moved_on_torque_drives() -> Result<(), Box<dyn Error>> {
    main()
}
