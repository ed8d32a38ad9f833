//! The whole tick: measuring, checking, following a line, computed torque, current loops.
//!
//! The controller gets the samples of an arm that is exactly where it should be, so that
//! it runs every part of the tick but the faults.

use fivebar_firmware::planner::Planner;
use fivebar_firmware::safety::State;
use fivebar_firmware::{Controller, Move, MoveKind, Request, Sensed, Settings};
use fivebar_kinematics::Vec2;
use fivebar_kinematics::five_bar::Geometry;

/// θ1, θ4 where the arm begins [rad].
const START: [f32; 2] = [2.2, 0.9];
/// Bus voltage [ADC codes]: 24 V.
const BUS: u16 = 2048;

/// A controller on its way, one tick at a time.
pub(crate) struct Run {
    controller: Controller,
    planner: Planner,
    geometry: Geometry<f32>,
}

impl Run {
    /// An armed arm with a line of 40 mm before it. Nothing if any of it is refused.
    pub(crate) fn new() -> Option<Self> {
        let settings = Settings::BENCHTOP;
        let mut controller = Controller::new(&settings).ok()?;
        let mut planner = Planner::new(&settings).ok()?;
        controller.tick(&sensed([0.0; 2]));
        controller.request(Request::SetAngles(START)).ok()?;
        controller.request(Request::Arm).ok()?;
        controller.tick(&sensed([0.0; 2]));
        let [x, y] = controller.status().tool?;
        let line = Move {
            tag: 1,
            kind: MoveKind::Line {
                to: [x + 0.04, y],
                feed: 0.2,
            },
        };
        planner.push(&mut controller, &line).ok()?;
        Some(Self {
            controller,
            planner,
            geometry: Geometry::new(settings.lengths).ok()?,
        })
    }

    /// Plans on and gives the samples of the next tick, where the reference is now;
    /// nothing once the line is behind.
    pub(crate) fn next(&mut self) -> Option<Sensed> {
        self.controller.heard();
        self.planner.run(&mut self.controller);
        let status = self.controller.status();
        if status.state == State::Armed && self.planner.is_empty() && status.tick > 100 {
            return None;
        }
        let [x, y] = status.reference?;
        let mode = self.controller.working_mode();
        let pose = self.geometry.inverse(Vec2::new(x, y), mode).ok()?;
        let [start1, start4] = START;
        Some(sensed([pose.u1.angle() - start1, pose.u4.angle() - start4]))
    }

    /// The tick itself.
    #[inline(never)]
    pub(crate) fn tick(&mut self, sensed: &Sensed) -> [f32; 2] {
        self.controller.tick(sensed).duty
    }
}

/// What the sensors say with the joints turned by so much [rad].
fn sensed(turned: [f32; 2]) -> Sensed {
    let counts_per_radian = 8.0 * 8192.0 / core::f32::consts::TAU;
    Sensed {
        counts: turned.map(|angle| round(angle * counts_per_radian)),
        current: [2048; 2],
        bus_voltage: BUS,
        ..Sensed::default()
    }
}

fn round(value: f32) -> i32 {
    let half = if value < 0.0 { -0.5 } else { 0.5 };
    (value + half) as i32
}
