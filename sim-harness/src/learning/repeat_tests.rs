//! Learning of an arm whose errors and whose response to a shift are known.

use super::{Ended, Found, Repeats, Run, runs_of, sensed};
use crate::learning::LearningError;
use crate::learning::contraction::Filter;
use crate::learning::follower::Tick;
use crate::learning::shift::Learnt;
use crate::learning::timed_path::{Shown, TimedPath};
use crate::simulation::{Record, RunErrors, Summary};
use fivebar_files::robot::BuiltIn;
use fivebar_firmware::{Move, MoveKind};
use nalgebra::Vector2;
use std::f64::consts::{PI, TAU};

/// Ticks of the motion, at 10 kHz.
const TICKS: u32 = 8000;
const FILTER: Filter = Filter {
    half: 50.0,
    contraction: 0.5,
};

/// Goes to and fro, is deflected by `deflection` [m], and answers a shift by `response` times the shift.
struct KnownArm {
    deflection: fn(f64) -> Vector2<f64>,
    response: f64,
    runs: usize,
}

const LINE: Move = Move {
    tag: 7,
    tool: 0,
    kind: MoveKind::Line {
        to: [0.24, 0.2],
        feed: 0.1,
    },
};

/// 20 µm at 2.5 Hz, and 10 µm across at 7.5 Hz: none at both ends.
fn deflection(time: f64) -> Vector2<f64> {
    Vector2::new(
        20e-6 * (TAU * 2.5 * time).sin(),
        10e-6 * (TAU * 7.5 * time).sin(),
    )
}

fn at(tick: u32) -> Vector2<f64> {
    let share = f64::from(tick.min(TICKS)) / f64::from(TICKS);
    Vector2::new(0.02 * (1.0 - (PI * share).cos()), 0.2)
}

impl Repeats for KnownArm {
    fn run(&mut self, learnt: Option<&Learnt>, greatest: f64) -> Result<Run, LearningError> {
        self.runs += 1;
        let shift = |tick: u32| match learnt {
            Some(learnt) => learnt.path.at(&learnt.shifts[0], tick as usize),
            None => Vector2::zeros(),
        };
        let tick = |tick: u32| {
            let deflected = (self.deflection)(f64::from(tick) * 1e-4);
            let error = -deflected - shift(tick) * self.response;
            Tick {
                shown: Shown {
                    reference: (at(tick) + shift(tick)).into(),
                    moves: tick > 0,
                    tag: 7,
                },
                error: Some(error),
                place: learnt.map(|_| (0, tick as usize)),
            }
        };
        let ticks: Vec<Tick> = (0..=TICKS).map(tick).collect();
        let sensed = sensed(&ticks);
        Ok(Run {
            summary: Summary::default(),
            record: Record::default(),
            stopped: sensed.max_m > greatest,
            ticks,
            errors: RunErrors {
                sensed,
                ..RunErrors::default()
            },
        })
    }

    fn path(&self, run: &mut Run) -> Result<TimedPath, LearningError> {
        let robot = BuiltIn::find(BuiltIn::DEFAULT).unwrap().robot().unwrap();
        let shown: Vec<Shown> = run.ticks.iter().map(|tick| tick.shown).collect();
        let (path, ranges) = TimedPath::shown(&shown, &[LINE], &robot)?;
        assert_eq!(ranges.len(), 1);
        assert_eq!(ranges[0], 0..TICKS as usize + 1);
        for (at, tick) in run.ticks.iter_mut().enumerate() {
            tick.place = Some((0, at));
        }
        Ok(path)
    }
}

fn learn(response: f64, runs: usize, bound: f64) -> (Found, usize) {
    let mut arm = KnownArm {
        deflection,
        response,
        runs: 0,
    };
    let found = runs_of(&mut arm, runs, Some(&FILTER), bound, None).unwrap();
    (found, arm.runs)
}

#[test]
fn the_shift_becomes_the_deflection_with_its_sign_changed() {
    for response in [0.7, 1.0, 1.3] {
        let (found, _) = learn(response, 9, 1e-3);
        assert_eq!(found.ended, None, "{response}");
        let rms: Vec<f64> = found.all.iter().map(|run| run.sensed.rms_m).collect();
        // (20² + 10²)/2 µm², and a fifth and what the response leaves of it from run to run.
        assert!((rms[0] - 15.8e-6).abs() < 0.05e-6, "{rms:?}");
        let left = (1.0 - 0.8 * response).abs();
        assert!(rms[1] < (left + 0.1) * rms[0], "{rms:?} {response}");
        assert!(rms[8] < 0.7e-6, "{rms:?}");
        let learnt = found.followed.unwrap();
        for tick in (400..7600).step_by(97) {
            let shift = learnt.path.at(&learnt.shifts[0], tick as usize);
            let wanted = -deflection(f64::from(tick) * 1e-4) / response;
            assert!((shift - wanted).norm() < 1e-6, "{shift} for {wanted}");
        }
    }
}

#[test]
fn an_arm_that_answers_the_wrong_way_is_stopped_and_undone() {
    let (found, runs) = learn(-1.0, 9, 1e-3);
    assert_eq!(found.ended, Some(Ended::Diverged));
    assert_eq!(runs, 2);
    // What is kept is the first run's: no shift.
    assert_eq!(found.followed.unwrap().greatest(), 0.0);
}

#[test]
fn no_shift_is_greater_than_its_bound() {
    let (found, _) = learn(1.0, 5, 8e-6);
    let greatest = found.followed.unwrap().greatest();
    assert!((7.9e-6..=8.000001e-6).contains(&greatest), "{greatest} m");
}

#[test]
fn moves_of_the_joints_and_two_levels_in_a_line_are_refused() {
    let robot = BuiltIn::find(BuiltIn::DEFAULT).unwrap().robot().unwrap();
    let refused = |moves: &[Move]| {
        TimedPath::shown(&[], moves, &robot)
            .unwrap_err()
            .to_string()
    };
    let joints = Move {
        tag: 8,
        kind: MoveKind::Joint {
            to: [2.0, 1.0],
            speed: 0.5,
        },
        ..LINE
    };
    assert!(refused(&[LINE, joints]).starts_with("line 8 moves the joints"));
    let down = Move { tool: 1000, ..LINE };
    assert!(refused(&[LINE, down]).starts_with("line 7 has moves with two levels"));
    // The joints may lead to the beginning of the job.
    assert!(refused(&[joints, LINE]).starts_with("the job moves nothing"));
}
