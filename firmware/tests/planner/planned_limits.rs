//! Each limit of a planned path by itself.

use crate::rig::{Rig, settings};
use fivebar_firmware::MoveKind;
use fivebar_firmware::controller::{QueuedSegment, Request};
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::safety::{Fault, Limits, State};
use fivebar_kinematics::trajectory::TrajectorySegment;
use nalgebra::Vector2;

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
    };
    rig.controller.extend_path(before.path_generation, queued);
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
