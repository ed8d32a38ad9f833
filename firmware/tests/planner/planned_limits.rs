//! Each limit of a planned path by itself.

use crate::rig::{Rig, START, settings, with};
use fivebar_firmware::controller::{ExtraTorque, QueuedSegment, Request};
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::safety::{Fault, Limits, State};
use fivebar_firmware::{Move, MoveKind, Planner};
use fivebar_kinematics::trajectory::TrajectorySegment;
use nalgebra::Vector2;
use std::f32::consts::TAU;

/// On its way along 60 mm at 0.1 m/s.
fn running() -> Rig {
    let mut rig = Rig::armed(&settings());
    let [x, y] = rig.tool_position();
    let to = [x - 0.06, y];
    rig.push(1, MoveKind::Line { to, feed: 0.1 }).unwrap();
    rig.run(1000);
    rig
}

#[test]
fn an_arm_that_stops_takes_neither_moves_nor_segments() {
    let mut rig = running();
    rig.controller.request(Request::Stop).unwrap();
    let refused = rig.push(2, MoveKind::Dwell { duration: 0.1 }).unwrap_err();
    assert_eq!(refused.kind, MoveErrorKind::State(State::Stopping));
    let before = rig.controller.planning_snapshot();
    let queued = QueuedSegment {
        segment: TrajectorySegment::rest(Vector2::new(0.04, 0.2), 1.0, 5),
        open: false,
        limits: Limits::empty(),
        extra: ExtraTorque::ZERO,
    };
    rig.controller.extend_path(before.path_generation, &queued);
    let after = rig.controller.planning_snapshot();
    assert_eq!(after.path_left, before.path_left);
}

/// The greatest of √(6 v/j) = 95 ms and 1.5 v/a = 112.5 ms.
#[test]
fn a_stop_takes_the_time_that_the_limits_of_acceleration_and_jerk_need() {
    let mut rig = running();
    rig.controller.request(Request::Stop).unwrap();
    let ticks = (0..3000)
        .take_while(|_| {
            rig.tick();
            rig.controller.state() == State::Stopping
        })
        .count();
    assert!((1122..=1128).contains(&ticks), "{ticks} ticks");
}

#[test]
fn each_joint_has_its_own_limits() {
    for (to, joint) in [
        ([0.55, 0.9], 1),
        ([3.65, 0.9], 1),
        ([2.2, -0.5], 4),
        ([2.2, 2.58], 4),
    ] {
        let mut rig = Rig::armed(&settings());
        let refused = rig.push(1, MoveKind::Joint { to, speed: 0.1 }).unwrap_err();
        assert_eq!(refused.kind, MoveErrorKind::JointLimit(joint), "{to:?}");
    }
}

#[test]
fn a_line_is_refused_where_it_reaches_the_margin_from_a_singularity() {
    let mut rig = Rig::armed(&settings());
    let [x, y] = rig.tool_position();
    let to = [x, y + 0.3];
    let refused = rig.push(1, MoveKind::Line { to, feed: 0.1 }).unwrap_err();
    let [x, y] = refused.point.expect("a point on the line");
    let checked = settings().check().unwrap();
    let mode = rig.controller.working_mode();
    let pose = checked.tool().inverse(Vector2::new(x, y), mode).unwrap();
    let (_, margin) = checked.tool().nearest_singularity(&pose);
    assert!((margin - 0.15).abs() < 0.02, "{margin}");
}

#[test]
fn a_planner_that_falls_behind_stops_a_joint_move_on_its_way() {
    let mut rig = Rig::armed(&settings());
    let to = [2.6, 0.6];
    rig.push(1, MoveKind::Joint { to, speed: 0.02 }).unwrap();
    rig.run(1000);
    for _ in 0..10_000 {
        rig.controller.feed_host_timeout();
        rig.tick_alone();
    }
    assert_eq!(rig.controller.status().fault, Some(Fault::QueueUnderrun));
    let turned = rig.bench.theta[0] - 2.2;
    assert!(0.01 < turned && turned < 0.399, "{turned} rad");
}

/// The greatest difference of this order between points that are `STEP` ticks apart, per second to
/// that power.
fn peak(points: &[[f64; 2]], order: u32) -> f64 {
    const STEP: usize = 20;
    let mut values: Vec<[f64; 2]> = points.iter().copied().step_by(STEP).collect();
    for _ in 0..order {
        let pairs = values.windows(2);
        values = pairs
            .map(|pair| [0, 1].map(|i| pair[1][i] - pair[0][i]))
            .collect();
    }
    let greatest = values.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
    greatest / (STEP as f64 * 1e-4).powi(order as i32)
}

/// Reaches 90 % of each limit at least. A limit of the jerk is exceeded where the reported reference
/// changes its acceleration within a tick.
#[track_caller]
fn assert_reaches(peaks: [f64; 3], limits: [f64; 3]) {
    for (peak, limit) in peaks.into_iter().zip(limits) {
        assert!((0.9..=1.1).contains(&(peak / limit)), "{peak} of {limit}");
    }
}

#[test]
fn a_line_keeps_the_tools_own_limits_of_speed_acceleration_and_jerk() {
    let settings = with(|settings| {
        settings.motion.max_speed = 0.2;
        settings.motion.max_acceleration = 4.0;
        settings.motion.max_jerk = 150.0;
    });
    let mut rig = Rig::armed(&settings);
    let [x, y] = rig.tool_position();
    let to = [x - 0.06, y];
    rig.push(1, MoveKind::Line { to, feed: 5.0 }).unwrap();
    let mut points = Vec::new();
    while rig.controller.state() != State::Armed || !rig.planner.is_empty() {
        rig.tick();
        points.extend(
            rig.controller
                .status()
                .reference
                .map(|point| point.map(f64::from)),
        );
    }
    assert_reaches(
        [1, 2, 3].map(|order| peak(&points, order)),
        [0.2, 4.0, 150.0],
    );
}

#[test]
fn a_joint_move_keeps_the_joints_own_limits_of_speed_and_acceleration() {
    for joint in [0, 1] {
        let mut to = START;
        to[joint] -= 0.4;
        let settings = with(|settings| {
            settings.motion.max_acceleration = 40.0;
            settings.motion.max_jerk = 4000.0;
            for axis in &mut settings.axes {
                (axis.max_speed, axis.max_acceleration) = (2.0, 40.0);
            }
        });
        let mut rig = Rig::armed(&settings);
        rig.push(1, MoveKind::Joint { to, speed: 1.0 }).unwrap();
        let mut peaks = [0.0_f32; 2];
        while rig.controller.state() != State::Armed || !rig.planner.is_empty() {
            rig.tick();
            let reference = rig.controller.status().joint_reference.expect("armed");
            for (peak, value) in peaks
                .iter_mut()
                .zip([reference.velocity, reference.acceleration])
            {
                *peak = peak.max(value[joint].abs());
            }
        }
        let [speed, acceleration] = peaks.map(f64::from);
        // A move of one joint has no bends, so all but the reserve is for its acceleration.
        assert_reaches([speed, acceleration, 1.0], [2.0, 38.0, 1.0]);
    }
}

#[test]
fn moves_behind_a_joint_move_are_planned_in_its_working_mode() {
    let mut rig = Rig::armed(&settings());
    // Through the straight leg 1, to 0.05 rad from the end of joint 1's range.
    let turn = MoveKind::Joint {
        to: [0.65, 0.9],
        speed: 0.1,
    };
    let planned = |kind| Move {
        tag: 1,
        tool: 0,
        kind,
    };
    let end = rig.planner.check(rig.tool_position(), &planned(turn));
    let end = end.expect("a turn");
    rig.push(1, turn).expect("a turn");
    let in_mode = |elbows_left| {
        let settings = with(|s| s.elbows_left = elbows_left);
        Planner::new(&settings.check().expect("valid settings"))
    };
    let [before, after] = [[false, true], [true, true]].map(in_mode);
    let mut differ = 0;
    for direction in 0..16 {
        let (sin, cos) = (direction as f32 * TAU / 16.0).sin_cos();
        let to = [end[0] + 0.015 * cos, end[1] + 0.015 * sin];
        let line = planned(MoveKind::Line { to, feed: 0.05 });
        let refusal = |planner: &Planner| planner.check(end, &line).err().map(|error| error.kind);
        assert_eq!(refusal(&rig.planner), refusal(&after), "{direction}");
        differ += u32::from(refusal(&before) != refusal(&after));
    }
    assert!(differ > 2, "{differ} of 16");
}

#[test]
fn every_slowed_move_of_a_full_queue_is_reported() {
    let mut rig = Rig::armed(&settings());
    let [x, y] = rig.tool_position();
    let mut to = [x, y];
    for tag in 0..20_u8 {
        let step = if tag % 2 == 0 { 0.004 } else { -0.004 };
        to = [to[0] + step, to[1] - 0.001];
        let feed = 5.0;
        rig.push(u32::from(tag), MoveKind::Line { to, feed })
            .unwrap();
    }
    let mut reported = [false; 20];
    while rig.controller.state() != State::Armed || !rig.planner.is_empty() {
        rig.tick();
        let status = rig.controller.status();
        if let Some(tag) = status.tag {
            reported[tag as usize] |= status.limits.contains(Limits::SPEED);
        }
    }
    assert_eq!(reported, [true; 20]);
}
