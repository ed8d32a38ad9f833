//! The time along the path over hours, stops and thousands of segments.

use super::*;
use crate::Settings;
use crate::settings::ToolOutputSettings;
use fivebar_kinematics::trajectory::{LookaheadPlanner, MotionLimits};
use nalgebra::Vector2;

const PERIOD: f32 = 1e-4;
const STOPPING_TIME: f32 = 0.1;

fn no_path() -> Path {
    let settings = Settings::BENCHTOP.check().unwrap();
    Path::new(STOPPING_TIME, PERIOD, PathOutput::new(&settings))
}

fn path_of(lookahead: &mut LookaheadPlanner<f32, 4>) -> Path {
    let mut path = no_path();
    while let Some(segment) = lookahead.next_segment() {
        path.push(&queued(segment));
    }
    path
}

fn queued(segment: TrajectorySegment<f32>) -> QueuedSegment {
    QueuedSegment {
        segment,
        open: false,
        limits: Limits::empty(),
        extra: ExtraTorque::ZERO,
    }
}

fn dwell(duration: f32) -> Path {
    let mut lookahead = LookaheadPlanner::new();
    lookahead.push_dwell(Vector2::zeros(), duration, 0).unwrap();
    path_of(&mut lookahead)
}

/// Joint 1 by 1 rad at `speed` [rad/s]; lasts 1/speed and the time of the acceleration.
fn turn(speed: f32) -> Path {
    let motion_limits = MotionLimits {
        speed,
        acceleration: 10.0,
        jerk: 1e4,
    };
    let mut lookahead = LookaheadPlanner::new();
    lookahead
        .push_joint([0.0; 2], [1.0, 0.0], motion_limits, 0)
        .unwrap();
    path_of(&mut lookahead)
}

/// Number of queued segments and their duration [s].
fn waiting(path: Path) -> (u32, f64) {
    let mut queue = path.queue;
    let (mut count, mut duration) = (0, 0.0);
    while let Some(first) = queue.first() {
        count += 1;
        duration += f64::from(first.queued.segment.duration());
        if queue.is_last() {
            break;
        }
        queue.pass();
    }
    (count, duration)
}

/// θ1 [rad] and ω1 [rad/s].
fn joint1(step: &Step<'_>) -> (f64, f64) {
    match step.reference() {
        Reference::Joint { angles, rates, .. } => (angles[0].into(), rates[0].into()),
        Reference::Tool { .. } => panic!("a move of the joints"),
    }
}

fn ticks_to_rest(path: &mut Path) -> u64 {
    (1..)
        .find(|_| path.step().expect("a path").at_rest)
        .expect("an end")
}

/// Single precision resolves a time to 1 in 10⁷, and the end falls between two ticks.
fn assert_lasts(path: &mut Path, duration: f64) {
    let ticks = ticks_to_rest(path) as f64;
    let late = ticks * 1e-4 - duration;
    let bound = 1e-4 + 1.5e-7 * duration;
    assert!(late.abs() <= bound, "{late} s late after {duration} s");
}

#[test]
fn a_dwell_ends_on_its_tick_however_long() {
    for duration in [0.02, 1.0, 100.0, 1800.0] {
        assert_lasts(&mut dwell(duration), duration.into());
    }
}

#[test]
fn a_slow_move_takes_its_time() {
    let (count, duration) = waiting(turn(2e-3));
    assert!(duration > 500.0 && count > 1);
    assert_lasts(&mut turn(2e-3), duration);
}

/// From the steady speed v at θ₀: θ = θ₀ + v T(x − x³ + ½x⁴), ω = v(1 − 3x² + 2x³).
#[test]
fn a_stop_is_as_smooth_late_in_a_long_segment_as_early() {
    for late in [100, 9_000_000] {
        let speed = 1e-3;
        let mut path = turn(speed as f32);
        let mut before = (0.0, 0.0);
        for _ in 0..late {
            before = joint1(&path.step().expect("a path"));
        }
        path.brake();
        for tick in 1.. {
            let step = path.step().expect("a path");
            let x: f64 = (f64::from(tick) * 1e-3).min(1.0);
            let (angle, rate) = joint1(&step);
            let distance = speed * 0.1 * (x - x.powi(3) + 0.5 * x.powi(4));
            // Single precision resolves minutes to 6e-5 s.
            assert!(
                (angle - before.0 - distance).abs() < 1.5e-7,
                "{angle} at {x}"
            );
            let expected = speed * (1.0 + x * x * (2.0 * x - 3.0));
            assert!((rate - expected).abs() < 1e-3 * speed, "{rate} at {x}");
            if step.at_rest {
                assert!((tick - 1000_i32).abs() <= 1, "{tick} ticks");
                break;
            }
        }
    }
}

#[test]
fn a_stop_takes_two_ticks_at_least_however_near_the_end_of_its_path() {
    // Ticks to the end of a path that ends in motion: 2.5 and 1.5.
    for passed in [9998, 9999] {
        let mut path = no_path();
        path.push(&QueuedSegment {
            open: true,
            ..queued(TrajectorySegment::rest(Vector2::zeros(), 1.000_05, 0))
        });
        for _ in 0..passed {
            assert!(!path.step().expect("a path").at_rest);
        }
        path.brake();
        assert_eq!(ticks_to_rest(&mut path), 2);
    }
}

#[test]
fn the_time_left_is_that_of_the_segments_after_any_number_of_them() {
    let mut path = dwell(0.01);
    let mut segments = [0.000_31_f32, 0.0117, 0.0008, 0.0042].into_iter().cycle();
    for _ in 0..200_000 {
        while path.left() < 0.05 && path.free() > 0 {
            let segment = dwell(segments.next().expect("endless"))
                .queue
                .first()
                .expect("a segment")
                .queued;
            path.push(&segment);
        }
        path.step().expect("a path");
    }
    let passed = f64::from(path.offset) + 1e-4 * f64::from(path.ticks);
    let left = f64::from(path.committed_left);
    let (_, all) = waiting(path);
    // Each of at most 32 segments was cut to whole microseconds.
    assert!((left - (all - passed)).abs() < 4e-5);
}

/// Segments shorter than a tick: a tick passes two, and the path waits for the next tick.
#[test]
fn segments_shorter_than_a_tick_are_passed_two_at_a_time() {
    let mut path = no_path();
    for tag in 0..6 {
        let mut lookahead = LookaheadPlanner::<f32, 4>::new();
        lookahead
            .push_dwell(Vector2::zeros(), 0.2 * PERIOD, tag)
            .unwrap();
        path.push(&queued(lookahead.next_segment().unwrap()));
    }
    for (tag, at_rest) in [(2, false), (4, false), (5, true)] {
        let rests = path.step().expect("a path").at_rest;
        assert_eq!((path.tag(), rests), (Some(tag), at_rest));
        assert!(
            path.committed_left > -1e-9,
            "{} s left",
            path.committed_left
        );
    }
}

/// The first segment of a dwell of `duration` [s], which ends in motion if `open`.
fn segment(duration: f32, open: bool) -> QueuedSegment {
    let mut lookahead = LookaheadPlanner::<f32, 4>::new();
    lookahead.push_dwell(Vector2::zeros(), duration, 0).unwrap();
    QueuedSegment {
        open,
        ..queued(lookahead.next_segment().expect("a segment"))
    }
}

/// A stop needs T/2, two ticks, and ten until it begins, 51.2 ms; 20 ms more are waited for.
#[test]
fn a_path_that_ends_in_motion_begins_when_it_lasts_longer_than_a_stop() {
    for (duration, begins) in [(0.001, false), (0.0707, false), (0.0717, true)] {
        let mut path = no_path();
        path.push(&segment(duration, true));
        assert_eq!(path.is_enough(), begins, "{duration} s");
        assert_eq!(path.step().is_some(), begins, "{duration} s");
    }
    let mut path = no_path();
    path.push(&segment(0.001, false));
    assert!(path.step().is_some(), "a path that ends at rest");
}

#[test]
fn a_path_runs_short_when_a_stop_needs_all_that_is_left_of_it() {
    for (left, short) in [(0.051, true), (0.0514, false)] {
        let mut path = no_path();
        path.push(&segment(0.1, true));
        let passed = ((0.1 - left) / 1e-4) as u32;
        for _ in 0..passed {
            path.step().expect("a path");
        }
        assert_eq!(path.runs_short(), short, "{} s left", path.left());
    }
}

/// 20 segments of 1 ms: the planner keeps the queue full, but not long.
#[test]
fn a_path_of_many_short_segments_does_not_run_short() {
    let mut path = no_path();
    path.push(&segment(0.1, true));
    for _ in 0..800 {
        path.step().expect("a path");
    }
    assert!(path.runs_short());
    for _ in 0..20 {
        path.push(&segment(0.001, true));
    }
    path.step().expect("a path");
    assert!(!path.runs_short(), "{} s left", path.left());
}

#[test]
fn a_path_that_ends_at_rest_or_stops_never_runs_short() {
    let mut at_rest = dwell(0.01);
    at_rest.step().expect("a path");
    assert!(!at_rest.runs_short());
    let mut stopping = no_path();
    stopping.push(&segment(0.1, true));
    for _ in 0..600 {
        stopping.step().expect("a path");
    }
    assert!(stopping.runs_short());
    stopping.brake();
    assert!(!stopping.runs_short());
}

#[test]
fn the_time_left_counts_every_pushed_segment_once() {
    let mut path = no_path();
    assert_eq!(path.left(), 0.0);
    for (number, open) in [(1_u8, false), (2, true), (3, true), (4, false)] {
        path.push(&segment(0.01, open));
        let expected = 0.01 * f32::from(number);
        assert!((path.left() - expected).abs() < 1e-6, "{}", path.left());
    }
    path.clear();
    assert_eq!((path.left(), path.tag()), (0.0, None));
}

#[test]
fn a_path_is_full_after_as_many_segments_as_it_has_room_for() {
    let mut path = no_path();
    for free in (1..=QUEUED_SEGMENTS).rev() {
        assert_eq!(path.free(), free);
        path.push(&segment(0.0001, true));
    }
    assert!(path.free() == 0 && path.is_enough());
    let left = path.left();
    path.push(&segment(0.0001, true));
    assert_eq!(path.left(), left, "no free for more");
}

/// A stop advances by T/2, and T is at most twice what is left, less two ticks to get there.
#[test]
fn a_stop_on_a_path_too_short_for_it_ends_before_the_path_does() {
    for (left, ticks) in [(0.03, 596), (0.003, 56), (0.0007, 10), (0.0003, 2)] {
        let mut path = no_path();
        path.push(&segment(0.1, true));
        for _ in 0..((0.1 - left) / 1e-4_f64).round() as u32 {
            path.step().expect("a path");
        }
        path.brake();
        let taken = i64::try_from(ticks_to_rest(&mut path)).expect("few");
        assert!(
            (taken - ticks).abs() <= 1,
            "{taken} ticks with {left} s left"
        );
    }
}

#[test]
fn the_acceleration_of_a_stop_is_the_change_of_its_rate() {
    let mut path = turn(1e-2);
    for _ in 0..1000 {
        path.step().expect("a path");
    }
    path.brake();
    let of = |step: &Step<'_>| match step.reference() {
        Reference::Joint {
            rates,
            accelerations,
            ..
        } => (f64::from(rates[0]), f64::from(accelerations[0])),
        Reference::Tool { .. } => panic!("a move of the joints"),
    };
    let (mut rate, mut before) = of(&path.step().expect("a path"));
    for tick in 1..990 {
        let (next, acceleration) = of(&path.step().expect("a path"));
        let change = (next - rate) / 1e-4;
        let mean = 0.5 * (acceleration + before);
        assert!((change - mean).abs() < 2e-3, "{change}, {mean} at {tick}");
        (rate, before) = (next, acceleration);
    }
}

#[test]
fn a_stop_takes_two_ticks_at_least() {
    for left in [0.0002, 0.0001] {
        let mut path = no_path();
        path.push(&segment(0.1, true));
        for _ in 0..((0.1 - left) / 1e-4_f64).round() as u32 {
            path.step().expect("a path");
        }
        path.brake();
        let ticks = (1..100).find(|_| path.step().expect("a path").at_rest);
        assert!(matches!(ticks, Some(2 | 3)), "{ticks:?} with {left} s left");
    }
}

/// A power goes off where a path ends, and comes back with segments that were pushed before.
#[test]
fn segments_pushed_behind_the_end_of_a_path_switch_the_tool_on_again() {
    let settings = Settings {
        tool_output: ToolOutputSettings::Power {
            frequency: 1e4,
            scale_with_speed: false,
        },
        ..Settings::BENCHTOP
    };
    let settings = settings.check().unwrap();
    let mut path = Path::new(STOPPING_TIME, PERIOD, PathOutput::new(&settings));
    let mut lookahead = LookaheadPlanner::<f32, 16>::new();
    let mut push = |path: &mut Path, level, open| {
        lookahead.set_tool_output(settings.tool_output.output(level, 1.0));
        lookahead.push_dwell(Vector2::zeros(), 5e-3, 0).unwrap();
        let segment = lookahead.next_segment().unwrap();
        path.push(&QueuedSegment {
            open,
            ..queued(segment)
        });
    };
    let run = |path: &mut Path| {
        let (mut on, mut first) = (0, None);
        for tick in 0.. {
            if path.step().unwrap().at_rest {
                path.finish();
                break;
            }
            if path.tool_output() == 700 {
                on += 1;
                first.get_or_insert(tick);
            }
        }
        (on, first)
    };
    push(&mut path, 700, false);
    push(&mut path, 700, true);
    // 50 ticks, the last of which ends the segment; the delay is 3.
    assert_eq!(run(&mut path), (46, Some(3)));
    assert_eq!(path.tool_output(), 0);
    push(&mut path, 0, false);
    assert_eq!(run(&mut path), (49, Some(3)));
}
