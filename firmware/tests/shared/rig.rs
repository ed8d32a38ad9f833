//! A bench for the controller alone: the benchtop arm's settings and a small plant of its
//! own in f64, so that the firmware is tested without the simulator.

#![allow(dead_code, reason = "each binary uses its own part")]
#![allow(
    clippy::needless_range_loop,
    reason = "a joint's number names it in every array"
)]

use fivebar_firmware::controller::{Controller, Request};
use fivebar_firmware::drives::{BrushedCommand, BrushedSample};
use fivebar_firmware::motion::StreamPoint;
use fivebar_firmware::planner::{MoveError, Planner};
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::{AxisSettings, ControlSettings, ProtectionSettings, Settings};
use fivebar_firmware::{ActuatorCommand, FULL_TOOL, Move, MoveKind, SensorSample};
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Joint, Side};
use nalgebra::Vector2;
use rtic_core::Mutex;
use std::f64::consts::TAU;

/// Where the bench arm starts: crank angles of an upright pose [rad].
pub(crate) const START: [f32; 2] = [2.2, 0.9];

/// Ticks for which the bridges are given time to wake up: 1.5 ms, and one more because a command
/// acts from the next tick on.
pub(crate) const WAKING_TICKS: u32 = 16;

/// The bridges off and the brake engaged.
pub(crate) const OFF: ActuatorCommand = ActuatorCommand {
    drives: BrushedCommand { duty: [0.0; 2] },
    enable: [false; 2],
    brake: true,
    tool: 0,
};

/// The benchtop arm with coarser encoders and looser protection.
pub(crate) fn settings() -> Settings {
    const BENCHTOP: Settings = Settings::BENCHTOP;
    Settings {
        axes: BENCHTOP.axes.map(|axis| AxisSettings {
            encoder_counts: 8192,
            index_counts: 8192,
            ..axis
        }),
        control: ControlSettings {
            integral_rate: 30.0,
            ..BENCHTOP.control
        },
        protection: ProtectionSettings {
            following_error: 0.05,
            over_speed: 50.0,
            over_current: 6.0,
            bus_voltage: [18.0, 30.0],
            bus_voltage_per_code: 0.01,
            command_timeout: 0.1,
        },
        ..BENCHTOP
    }
}

/// The same with a change.
pub(crate) fn with(change: impl FnOnce(&mut Settings)) -> Settings {
    let mut settings = settings();
    change(&mut settings);
    settings
}

/// An arm with its motors, one tick at a time.
pub(crate) struct Bench {
    arm: Arm<f64>,
    settings: Settings,
    /// θ1, θ4 [rad].
    pub(crate) theta: [f64; 2],
    /// ω1, ω4 [rad/s].
    pub(crate) omega: [f64; 2],
    /// Motor currents [A].
    pub(crate) current: [f64; 2],
    /// Torque from outside on each joint [N·m].
    pub(crate) push: [f64; 2],
    /// Bus voltage [V].
    pub(crate) bus: f64,
    /// The other values of the sample.
    pub(crate) overlay: SensorSample,
    /// A fixed state of both home switches, whatever the arm does.
    pub(crate) stuck: Option<[bool; 2]>,
    /// How far each switch closes behind the home angle [rad]: there, one with an index pulse has the pulse.
    pub(crate) switch_behind: [f64; 2],
    /// Encoders without index pulses.
    pub(crate) no_index: bool,
    /// Added to the counts.
    pub(crate) extra_counts: [i32; 2],
    /// What each current sensor shows of a current [A].
    pub(crate) current_sensor: [fn(f64) -> f64; 2],
    /// The counts of encoders that are stuck.
    pub(crate) stuck_counts: [Option<i32>; 2],
    /// Whether a joint is held, whatever acts on it.
    pub(crate) jammed: [bool; 2],
    /// Measured less true angle of each encoder's shaft, by the measured angle [rad].
    pub(crate) encoder_error: fn(f64) -> f64,
    command: ActuatorCommand,
}

impl Bench {
    pub(crate) fn new(settings: &Settings) -> Self {
        let single = |value: f32| f64::from(value);
        let arm = Arm::new(
            Geometry::new(settings.lengths.map(single)).unwrap(),
            settings.links.map(|link| Link {
                mass: single(link.mass),
                com: Vector2::new(single(link.com[0]), single(link.com[1])),
                inertia: single(link.inertia),
            }),
            single(settings.payload),
            Vector2::new(single(settings.gravity[0]), single(settings.gravity[1])),
            settings
                .axes
                .map(|axis| single(axis.gear_ratio * axis.gear_ratio * axis.rotor_inertia)),
        )
        .unwrap();
        Self {
            arm,
            settings: *settings,
            theta: START.map(single),
            omega: [0.0; 2],
            current: [0.0; 2],
            push: [0.0; 2],
            bus: 24.0,
            overlay: SensorSample::default(),
            stuck: None,
            switch_behind: [0.0; 2],
            no_index: false,
            extra_counts: [0; 2],
            current_sensor: [|current| current; 2],
            stuck_counts: [None; 2],
            jammed: [false; 2],
            encoder_error: |_| 0.0,
            command: ActuatorCommand::default(),
        }
    }

    /// Makes the motors and joints differ from what the controller's settings state.
    pub(crate) fn change(&mut self, change: impl FnOnce(&mut Settings)) {
        change(&mut self.settings);
    }

    /// The samples of this instant.
    pub(crate) fn sense(&self) -> SensorSample {
        let axes = &self.settings.axes;
        let counts = |joint: Joint| {
            let shaft = self.theta[joint] * f64::from(axes[joint].gear_ratio);
            let measured =
                (0..20).fold(shaft, |measured, _| shaft + (self.encoder_error)(measured));
            let counts = (measured / TAU * f64::from(axes[joint].encoder_counts)).round() as i32;
            counts.wrapping_add(self.extra_counts[joint])
        };
        let code = |joint: Joint| {
            let shown = self.current_sensor[joint](self.current[joint]);
            let codes = shown / f64::from(axes[joint].current_per_code);
            (codes + f64::from(axes[joint].current_zero_code)).round() as u16
        };
        let switch = |joint: Joint| {
            let axis = &self.settings.axes[joint];
            let beyond = self.theta[joint] - f64::from(axis.home_angle);
            let behind = self.switch_behind[joint];
            if axis.home_forward {
                beyond >= behind
            } else {
                beyond < -behind
            }
        };
        // One count in each turn of the encoder.
        let index = |joint: Joint| {
            let axis = &axes[joint];
            let shaft = f64::from(axis.home_angle * axis.gear_ratio);
            let at_home = (shaft / TAU * f64::from(axis.encoder_counts)).round() as i32;
            let counts = counts(joint).wrapping_sub(self.extra_counts[joint]);
            (counts - at_home) % axis.index_counts as i32 == 0 && !self.no_index
        };
        SensorSample {
            home: self.stuck.unwrap_or(Joint::ALL.map(switch)),
            index: Joint::ALL.map(index),
            counts: Joint::ALL
                .map(|joint| self.stuck_counts[joint].unwrap_or_else(|| counts(joint))),
            drives: BrushedSample {
                current: Joint::ALL.map(code),
                bus_voltage: (self.bus * 100.0).round() as u16,
            },
            ..self.overlay
        }
    }

    /// Advances by one tick; `command` acts from the next one on.
    pub(crate) fn step(&mut self, command: &ActuatorCommand) {
        const STEPS: u32 = 5;
        let acting = std::mem::replace(&mut self.command, *command);
        let dt = 1.0 / f64::from(self.settings.control.tick_rate) / f64::from(STEPS);
        for _ in 0..STEPS {
            let mut torque = self.push;
            for joint in 0..2 {
                let axis = &self.settings.axes[joint];
                let ratio = f64::from(axis.gear_ratio);
                let k = f64::from(axis.torque_constant) * ratio;
                if acting.enable[joint] {
                    let v = f64::from(acting.drives.duty[joint]) * self.bus - k * self.omega[joint];
                    let (r, l) = (f64::from(axis.resistance), f64::from(axis.inductance));
                    let a = (-r * dt / l).exp();
                    self.current[joint] = a * self.current[joint] + (1.0 - a) * v / r;
                } else {
                    self.current[joint] = 0.0;
                }
                let omega = self.omega[joint];
                torque[joint] += k * self.current[joint]
                    - f64::from(axis.viscous_friction) * omega
                    - f64::from(axis.coulomb_friction) * (omega / 0.005).tanh();
            }
            let alpha = self.accelerations(torque);
            for joint in 0..2 {
                self.omega[joint] += dt * alpha[joint];
                if self.jammed[joint] {
                    self.omega[joint] = 0.0;
                }
                self.theta[joint] += dt * self.omega[joint];
            }
        }
    }

    fn accelerations(&self, torque: [f64; 2]) -> [f64; 2] {
        let geometry = self.arm.geometry();
        let [theta1, theta4] = self.theta;
        let [omega1, omega4] = self.omega;
        let pose = geometry.forward(theta1, theta4, Side::Left).unwrap();
        let rates = geometry.forward_velocities(&pose, omega1, omega4).unwrap();
        self.arm
            .forward_dynamics(&pose, &rates, torque, Vector2::zeros())
            .unwrap()
    }

    /// The tool [m].
    pub(crate) fn tool(&self) -> [f64; 2] {
        let [theta1, theta4] = self.theta;
        let pose = self.arm.geometry().forward(theta1, theta4, Side::Left);
        let c = pose.unwrap().c;
        [c.x, c.y]
    }
}

/// A controller and its bench, which advance tick by tick together.
pub(crate) struct Rig {
    pub(crate) controller: Controller,
    pub(crate) planner: Planner,
    pub(crate) bench: Bench,
}

impl Rig {
    /// Stopped, not homed.
    pub(crate) fn new(settings: &Settings) -> Self {
        let mut rig = Self {
            controller: Controller::new(&settings.check().unwrap()),
            planner: Planner::new(&settings.check().unwrap()),
            bench: Bench::new(settings),
        };
        rig.run(1);
        rig
    }

    /// Homed by declaring the angles, and armed; the bridges are awake.
    pub(crate) fn armed(settings: &Settings) -> Self {
        let mut rig = Self::new(settings);
        rig.controller.request(Request::SetAngles(START)).unwrap();
        rig.controller.request(Request::Arm).unwrap();
        rig.run(WAKING_TICKS + 1);
        rig
    }

    /// Runs this number of ticks and returns the last command.
    pub(crate) fn run(&mut self, ticks: u32) -> ActuatorCommand {
        (0..ticks).fold(ActuatorCommand::default(), |_, _| self.tick())
    }

    /// One tick with a planner in time and a host that gives signs of life.
    pub(crate) fn tick(&mut self) -> ActuatorCommand {
        self.controller.feed_host_timeout();
        self.planner.run(&mut self.controller);
        self.tick_alone()
    }

    /// One tick without planner and host.
    pub(crate) fn tick_alone(&mut self) -> ActuatorCommand {
        let command = self.controller.tick(&self.bench.sense());
        self.bench.step(&command);
        let follows = matches!(self.controller.state(), State::Armed | State::Running);
        let off = self.controller.settings().tool_output.off();
        assert!(follows || command.tool == off, "the tool is on");
        command
    }

    /// Runs the planner this number of times, with a tick before each of its accesses to the
    /// controller.
    pub(crate) fn run_interrupted(&mut self, times: u32) {
        let mut interrupted = Interrupted {
            controller: &mut self.controller,
            bench: &mut self.bench,
        };
        for _ in 0..times {
            interrupted.controller.feed_host_timeout();
            self.planner.run(&mut interrupted);
        }
    }

    /// Gives the planner a point of a stream, with a tick before each of its accesses to the controller.
    pub(crate) fn take_point_interrupted(&mut self, n: u16, point: &StreamPoint) {
        let mut interrupted = Interrupted {
            controller: &mut self.controller,
            bench: &mut self.bench,
        };
        self.planner.take_point(&mut interrupted, n, point);
    }

    /// Gives the planner a move with the tool down.
    pub(crate) fn push(&mut self, tag: u32, kind: MoveKind) -> Result<(), MoveError> {
        self.planner.push(
            &mut self.controller,
            &Move {
                tag,
                tool: FULL_TOOL,
                kind,
            },
        )
    }

    /// The tool's position as the controller measures it [m].
    pub(crate) fn tool_position(&self) -> [f32; 2] {
        let (tool, _) = self.controller.hold_position().unwrap();
        [tool.x, tool.y]
    }
}

/// A controller that runs a tick before each access.
struct Interrupted<'a> {
    controller: &'a mut Controller,
    bench: &'a mut Bench,
}

impl Mutex for Interrupted<'_> {
    type T = Controller;

    fn lock<R>(&mut self, work: impl FnOnce(&mut Controller) -> R) -> R {
        let command = self.controller.tick(&self.bench.sense());
        self.bench.step(&command);
        work(self.controller)
    }
}
