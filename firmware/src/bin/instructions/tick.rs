//! The whole tick: measuring, checking, following a path, computed torque, current loops.
//!
//! The controller gets the samples of an arm that is exactly where it should be, with the
//! currents that it should have. The courses beyond the plain line have the longest ticks that
//! we found how to make: segments shorter than a tick, corners and arcs, stops in the midst of
//! them, a fault that brakes the arm, and a tool beside C.

use core::hint::black_box;
use fivebar_firmware::board::instructions::InstructionCounter;
use fivebar_firmware::planner::Planner;
use fivebar_firmware::safety::State;
use fivebar_firmware::{Controller, Move, MoveKind, Request, Sensed, Settings};

/// θ1, θ4 where the arm begins [rad].
const START: [f32; 2] = [2.2, 0.9];
/// Bus voltage [ADC codes]: 24 V.
const BUS: u16 = 2048;
/// Speed of every move [m/s].
const FEED: f32 = 0.3;

/// A way to go, and what happens on it.
pub(crate) struct Course {
    pub(crate) name: &'static str,
    /// The n-th move, its start being this far from the beginning [m].
    moves: fn(u16) -> MoveKind,
    /// How many there are at most.
    count: u16,
    /// The tool from C [m].
    tool_offset: [f32; 2],
    /// Ticks from one stop to the next.
    stop_every: u32,
    /// Nobody says anything after the beginning.
    silent: bool,
}

const PLAIN: Course = Course {
    name: "the whole tick along a line",
    moves: |_| line(0.04, 0.0),
    count: 1,
    tool_offset: [0.0; 2],
    stop_every: u32::MAX,
    silent: false,
};

/// What is run, in the order of the table.
pub(crate) const COURSES: [Course; 7] = [
    PLAIN,
    Course {
        name: "the whole tick along lines shorter than a tick",
        moves: short,
        count: 400,
        ..PLAIN
    },
    Course {
        name: "the whole tick along arcs, as the host falls silent",
        moves: arcs,
        count: 400,
        silent: true,
        ..PLAIN
    },
    Course {
        name: "the whole tick in corners, stopped now and then",
        moves: corners,
        count: 400,
        stop_every: 97,
        ..PLAIN
    },
    Course {
        name: "tool beside C: lines shorter than a tick, stops",
        moves: short,
        count: 400,
        tool_offset: [0.02, 0.01],
        stop_every: 97,
        ..PLAIN
    },
    Course {
        name: "tool beside C: arcs, as the host falls silent",
        moves: arcs,
        count: 400,
        tool_offset: [0.02, 0.01],
        silent: true,
        ..PLAIN
    },
    Course {
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

/// `kind` with its places counted from `[x, y]` [m].
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

/// A controller on its way, one tick at a time.
pub(crate) struct Run<'a> {
    course: &'a Course,
    controller: Controller,
    planner: Planner,
    /// Where the moves are counted from [m].
    start: [f32; 2],
    /// Moves given since.
    given: u16,
    ticks: u32,
}

impl<'a> Run<'a> {
    /// An armed arm with its course before it. Nothing if any of it is refused.
    pub(crate) fn new(course: &'a Course) -> Option<Self> {
        let settings = Settings {
            tool_offset: course.tool_offset,
            ..Settings::BENCHTOP
        };
        let mut controller = Controller::new(&settings).ok()?;
        let planner = Planner::new(&settings).ok()?;
        controller.tick(&sensed([0.0; 2], [0.0; 2]));
        controller.request(Request::SetAngles(START)).ok()?;
        controller.request(Request::Arm).ok()?;
        controller.tick(&sensed([0.0; 2], [0.0; 2]));
        Some(Self {
            course,
            start: controller.status().tool?,
            controller,
            planner,
            given: 0,
            ticks: 0,
        })
    }

    /// Plans on and gives the samples of the next tick, where the reference is now;
    /// nothing once the arm is at rest at the end.
    pub(crate) fn next(&mut self) -> Option<Sensed> {
        self.ticks += 1;
        if !self.course.silent {
            self.controller.feed_host_timeout();
        }
        if self.ticks % self.course.stop_every == 0 {
            self.controller.request(Request::Stop).ok()?;
        }
        self.give();
        self.planner.run(&mut self.controller);
        let status = self.controller.status();
        let at_rest = match status.state {
            State::Armed => self.planner.is_empty() && self.given >= self.course.count,
            State::Fault => status.tag.is_none(),
            _ => false,
        };
        if at_rest && self.ticks > 100 {
            return None;
        }
        let angles = status.joint_reference?.angle;
        let [start1, start4] = START;
        let [theta1, theta4] = angles;
        Some(sensed(
            [theta1 - start1, theta4 - start4],
            status.current_demand,
        ))
    }

    /// As many moves as there is room for, counted anew where the arm was stopped.
    fn give(&mut self) {
        let held = self.planner.is_empty() && self.controller.state() == State::Armed;
        if let (true, Some((tool, _))) = (held && self.given > 0, self.controller.hold_position())
            && self.course.stop_every < u32::MAX
            && self.ticks < 20 * self.course.stop_every
        {
            self.start = [tool.x, tool.y];
            self.given = 0;
        }
        while self.given < self.course.count {
            let order = Move {
                tag: 1,
                kind: shifted((self.course.moves)(self.given), self.start),
            };
            if self.planner.push(&mut self.controller, &order).is_err() {
                break;
            }
            self.given += 1;
        }
    }

    /// The instructions of the tick itself.
    #[inline(never)]
    pub(crate) fn tick(&mut self, counter: &InstructionCounter, sensed: &Sensed) -> u32 {
        let start = counter.now();
        let command = self.controller.tick(sensed);
        let instructions = counter.since(start);
        black_box(command);
        instructions
    }
}

/// What the sensors say with the joints turned by so much [rad], at these currents [A].
fn sensed(turned: [f32; 2], currents: [f32; 2]) -> Sensed {
    let counts_per_radian = 8.0 * 16384.0 / core::f32::consts::TAU;
    Sensed {
        counts: turned.map(|angle| round(angle * counts_per_radian)),
        current: currents.map(|current| (2048.5 + current * 256.0) as u16),
        bus_voltage: BUS,
        ..Sensed::default()
    }
}

fn round(value: f32) -> i32 {
    let half = if value < 0.0 { -0.5 } else { 0.5 };
    (value + half) as i32
}
