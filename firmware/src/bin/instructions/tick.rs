//! The whole tick: measuring, checking, following a path, computed torque, current loops.
//!
//! The controller gets the samples of an arm that is exactly at its reference, with the currents
//! of the set-point. The scenarios after the plain line have the worst ticks that we could
//! construct: segments shorter than a tick, corners and arcs, stops within them, a fault that
//! stops the arm, and a tool beside C.

use core::hint::black_box;
use fivebar_firmware::board::emulated::instructions::InstructionCounter;
use fivebar_firmware::drives::BrushedSample;
use fivebar_firmware::planner::Planner;
use fivebar_firmware::safety::State;
use fivebar_firmware::{Controller, Move, MoveKind, Request, SensorSample, Settings};

/// θ1, θ4 at the start [rad].
const START: [f32; 2] = [2.2, 0.9];
/// Bus voltage [ADC codes]: 24 V.
const BUS: u16 = 2048;
/// Speed of every move [m/s].
const FEED: f32 = 0.3;

/// A path, and the stops and faults along it.
pub(crate) struct Scenario {
    pub(crate) name: &'static str,
    /// The n-th move, in positions from the tool's start [m].
    moves: fn(u16) -> MoveKind,
    /// Number of moves.
    count: u16,
    /// The tool from C [m].
    tool_offset: [f32; 2],
    /// Ticks between two stops.
    stop_every: u32,
    /// The host is silent after the start.
    silent: bool,
}

const PLAIN: Scenario = Scenario {
    name: "the whole tick along a line",
    moves: |_| line(0.04, 0.0),
    count: 1,
    tool_offset: [0.0; 2],
    stop_every: u32::MAX,
    silent: false,
};

/// The scenarios, in the order of the table.
pub(crate) const SCENARIOS: [Scenario; 7] = [
    PLAIN,
    Scenario {
        name: "the whole tick along lines shorter than a tick",
        moves: short,
        count: 400,
        ..PLAIN
    },
    Scenario {
        name: "the whole tick along arcs, as the host falls silent",
        moves: arcs,
        count: 400,
        silent: true,
        ..PLAIN
    },
    Scenario {
        name: "the whole tick in corners, stopped now and then",
        moves: corners,
        count: 400,
        stop_every: 97,
        ..PLAIN
    },
    Scenario {
        name: "tool beside C: lines shorter than a tick, stops",
        moves: short,
        count: 400,
        tool_offset: [0.02, 0.01],
        stop_every: 97,
        ..PLAIN
    },
    Scenario {
        name: "tool beside C: arcs, as the host falls silent",
        moves: arcs,
        count: 400,
        tool_offset: [0.02, 0.01],
        silent: true,
        ..PLAIN
    },
    Scenario {
        name: "tool beside C: corners, stops",
        moves: corners,
        count: 400,
        tool_offset: [0.02, 0.01],
        stop_every: 97,
        ..PLAIN
    },
];

const fn line(x: f32, y: f32) -> MoveKind {
    MoveKind::Line {
        to: [x, y],
        feed: FEED,
    }
}

fn short(n: u16) -> MoveKind {
    line(-2e-5 * f32::from(n), 1e-6 * f32::from(n % 3))
}

fn corners(n: u16) -> MoveKind {
    line(-2e-4 * f32::from(n), 1e-4 * f32::from(n % 2))
}

fn arcs(n: u16) -> MoveKind {
    let from = -5e-4 * f32::from(n);
    MoveKind::Arc {
        to: [from - 5e-4, 0.0],
        center: [from - 2.5e-4, 0.0],
        clockwise: n % 2 == 0,
        feed: FEED,
    }
}

/// `kind` with its positions shifted by `[x, y]` [m].
fn shifted(kind: MoveKind, [x, y]: [f32; 2]) -> MoveKind {
    let by = |[dx, dy]: [f32; 2]| [x + dx, y + dy];
    match kind {
        MoveKind::Line { to, feed } => MoveKind::Line { to: by(to), feed },
        MoveKind::Arc {
            to,
            center,
            clockwise,
            feed,
        } => MoveKind::Arc {
            to: by(to),
            center: by(center),
            clockwise,
            feed,
        },
        other => other,
    }
}

/// A controller that runs a scenario, one tick at a time.
pub(crate) struct Run<'a> {
    scenario: &'a Scenario,
    controller: Controller,
    planner: Planner,
    /// The origin of the moves [m].
    start: [f32; 2],
    /// Moves given from that origin.
    given: u16,
    ticks: u32,
}

impl<'a> Run<'a> {
    /// An armed arm at the start of the scenario; none if a request is refused.
    pub(crate) fn new(scenario: &'a Scenario) -> Option<Self> {
        let settings = Settings {
            tool_offset: scenario.tool_offset,
            ..Settings::BENCHTOP
        };
        let settings = settings.check().ok()?;
        let mut controller = Controller::new(&settings);
        let planner = Planner::new(&settings);
        controller.tick(&sample([0.0; 2], [0.0; 2]));
        controller.request(Request::SetAngles(START)).ok()?;
        controller.request(Request::Arm).ok()?;
        // The bridges wake up, and then the brake is released.
        while controller.tick(&sample([0.0; 2], [0.0; 2])).brake {}
        Some(Self {
            scenario,
            start: controller.status().tool?,
            controller,
            planner,
            given: 0,
            ticks: 0,
        })
    }

    /// Plans, and returns the sample of the next tick, at the present reference; none when the
    /// arm is at rest at the end.
    pub(crate) fn next(&mut self) -> Option<SensorSample> {
        self.ticks += 1;
        if !self.scenario.silent {
            self.controller.feed_host_timeout();
        }
        if self.ticks % self.scenario.stop_every == 0 {
            self.controller.request(Request::Stop).ok()?;
        }
        self.give();
        self.planner.run(&mut self.controller);
        let status = self.controller.status();
        let at_rest = match status.state {
            State::Armed => self.planner.is_empty() && self.given >= self.scenario.count,
            State::Fault => status.tag.is_none(),
            _ => false,
        };
        if at_rest && self.ticks > 100 {
            return None;
        }
        let angles = status.joint_reference?.angle;
        let [start1, start4] = START;
        let [theta1, theta4] = angles;
        Some(sample(
            [theta1 - start1, theta4 - start4],
            status.current_demand,
        ))
    }

    /// Gives as many moves as there is room for; after a stop, from the arm's position.
    fn give(&mut self) {
        let held = self.planner.is_empty() && self.controller.state() == State::Armed;
        if let (true, Some((tool, _))) = (held && self.given > 0, self.controller.hold_position())
            && self.scenario.stop_every < u32::MAX
            && self.ticks < 20 * self.scenario.stop_every
        {
            self.start = [tool.x, tool.y];
            self.given = 0;
        }
        while self.given < self.scenario.count {
            let next = Move {
                tag: 1,
                tool: 0,
                kind: shifted((self.scenario.moves)(self.given), self.start),
            };
            if self.planner.push(&mut self.controller, &next).is_err() {
                break;
            }
            self.given += 1;
        }
    }

    /// Runs the tick and returns its instructions.
    #[inline(never)]
    pub(crate) fn tick(&mut self, counter: &InstructionCounter, sample: &SensorSample) -> u32 {
        let start = counter.now();
        let command = self.controller.tick(sample);
        let instructions = counter.since(start);
        black_box(command);
        instructions
    }
}

/// The sample with the joints turned by these angles [rad], at these currents [A].
fn sample(turned: [f32; 2], currents: [f32; 2]) -> SensorSample {
    let counts_per_radian = 8.0 * 16384.0 / core::f32::consts::TAU;
    SensorSample {
        counts: turned.map(|angle| round(angle * counts_per_radian)),
        drives: BrushedSample {
            current: currents.map(|current| (2048.5 + current * 256.0) as u16),
            bus_voltage: BUS,
        },
        ..SensorSample::default()
    }
}

fn round(value: f32) -> i32 {
    let half = if value < 0.0 { -0.5 } else { 0.5 };
    (value + half) as i32
}
