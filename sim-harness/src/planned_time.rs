//! How long a job takes, before it runs.
//!
//! The controller's own planner plans the whole job, without the ticks between: it hands each part of the path to a
//! controller that rests, and the length of that path is the time. In a run the planner looks ahead as far as the
//! host has given it moves, here as far as it can. Jobs of long and of very short lines, arcs, dwells and timed moves
//! took this time within the 20 ms to which their runs were measured (host/fivebar/tests/ports/driving.rs).

use crate::path_queue::{duration, end};
use fivebar_firmware::controller::Request;
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::{Controller, Move, MoveKind, Planner, Settings};
use fivebar_kinematics::five_bar::{Side, WorkingMode};
use nalgebra::Vector2;
use std::f32::consts::TAU;

/// Where a job begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanStart {
    /// The tool [m].
    pub tool: [f32; 2],
    /// The arm's working mode.
    pub mode: WorkingMode,
    /// Its assembly mode.
    pub assembly: Side,
}

/// The time from the job's start to the end of each move [s]; none for moves that the planner refuses, or if
/// `goes_on` returns false.
pub fn planned_times(
    settings: &Settings,
    start: PlanStart,
    moves: &[Move],
    goes_on: &dyn Fn() -> bool,
) -> Option<Vec<f64>> {
    let mut dry = DryRun::new(settings, start)?;
    for (tag, next) in (1..).zip(moves) {
        if !goes_on() {
            return None;
        }
        match next.kind {
            MoveKind::Timed(timed) => {
                dry.pass(next, tag)?;
                dry.go_on_at(settings, timed.end(), false)?;
            }
            MoveKind::Crossing(plan) => {
                dry.pass(next, tag)?;
                dry.go_on_at(settings, plan.to, true)?;
            }
            MoveKind::Line { .. }
            | MoveKind::Arc { .. }
            | MoveKind::Joint { .. }
            | MoveKind::Dwell { .. } => dry.push(&Move { tag, ..*next })?,
        }
    }
    dry.finish()?;
    Some(spread(&dry.begun, dry.time, moves))
}

/// A planner and a controller that never ticks.
struct DryRun {
    planner: Planner,
    /// Rests armed at the start.
    resting: Controller,
    /// The time of the path that the planner has handed over [s].
    time: f64,
    /// The moves in progress at some of these times: tags and times [s].
    begun: Vec<(u32, f64)>,
}

impl DryRun {
    fn new(settings: &Settings, start: PlanStart) -> Option<Self> {
        let (planner, resting) = resting(settings, start)?;
        Some(Self {
            planner,
            resting,
            time: 0.0,
            begun: Vec::new(),
        })
    }

    fn push(&mut self, next: &Move) -> Option<()> {
        loop {
            match self.planner.push(&mut self.resting, next) {
                Ok(()) => return Some(()),
                Err(error) if error.kind == MoveErrorKind::Full => self.hand_over()?,
                Err(_) => return None,
            }
        }
    }

    /// Has the planner hand over some path; none if it has no more.
    fn hand_over(&mut self) -> Option<()> {
        let mut controller = self.resting.clone();
        self.planner.run(&mut controller);
        let time = f64::from(controller.planning_snapshot().path_left);
        if let Some(tag) = controller.status().tag {
            self.begun.push((tag, self.time));
        }
        self.time += time;
        (time > 0.0 || self.planner.is_empty()).then_some(())
    }

    fn finish(&mut self) -> Option<()> {
        while !self.planner.is_empty() {
            self.hand_over()?;
        }
        Some(())
    }

    /// A move whose time is given.
    fn pass(&mut self, next: &Move, tag: u32) -> Option<()> {
        self.finish()?;
        self.begun.push((tag, self.time));
        self.time += duration(None, next);
        Some(())
    }

    /// The arm is at another place [m], in the other assembly mode if it has `crossed`.
    fn go_on_at(&mut self, settings: &Settings, tool: [f32; 2], crossed: bool) -> Option<()> {
        let assembly = self.planner.assembly();
        let start = PlanStart {
            tool,
            mode: self.planner.workspace().mode,
            assembly: if crossed {
                assembly.opposite()
            } else {
                assembly
            },
        };
        (self.planner, self.resting) = resting(settings, start)?;
        Some(())
    }
}

/// A planner, and a controller that rests armed.
fn resting(settings: &Settings, start: PlanStart) -> Option<(Planner, Controller)> {
    let PlanStart {
        tool,
        mode,
        assembly,
    } = start;
    let settings = Settings {
        elbows_left: [mode.elbow1, mode.elbow4].map(|side| side == Side::Left),
        assembly_left: assembly == Side::Left,
        ..*settings
    };
    let settings = settings.check().ok()?;
    let pose = settings.tool().inverse(Vector2::from(tool), mode).ok()?;
    let [theta1, _, _, theta4] = pose.angles();
    let within = |angle: f32, [low, high]: [f32; 2]| {
        angle + TAU * ((0.5 * (low + high) - angle) / TAU).round()
    };
    let [axis1, axis4] = &settings.axes;
    let angles = [
        within(theta1, axis1.angle_limits),
        within(theta4, axis4.angle_limits),
    ];
    let mut controller = Controller::new(&settings);
    controller.request(Request::SetAngles(angles)).ok()?;
    controller.request(Request::Arm).ok()?;
    Some((Planner::new(&settings), controller))
}

/// The time to the end of each move, between the times at which some of them begin, in proportion to their times at
/// the feed rates.
fn spread(begun: &[(u32, f64)], whole: f64, moves: &[Move]) -> Vec<f64> {
    let (mut place, mut nominal) = (None, 0.0);
    let ends: Vec<f64> = moves
        .iter()
        .map(|next| {
            nominal += duration(place, next);
            place = end(next).or(place);
            nominal
        })
        .collect();
    let before = |tag: u32| match tag {
        0 | 1 => 0.0,
        tag => ends.get(tag as usize - 2).copied().unwrap_or(nominal),
    };
    let mut known: Vec<(f64, f64)> = vec![(0.0, 0.0)];
    known.extend(begun.iter().map(|&(tag, time)| (before(tag), time)));
    known.push((nominal, whole));
    let mut index = 0;
    ends.iter()
        .map(|&at| {
            while index + 2 < known.len() && known[index + 1].0 <= at {
                index += 1;
            }
            let [(from, begins), (to, ends)] = [known[index], known[index + 1]];
            match to > from {
                true => begins + (ends - begins) * ((at - from) / (to - from)).clamp(0.0, 1.0),
                false => ends,
            }
        })
        .collect()
}
