//! Forces and torques that the points of the modes Tip and Joint add.

use crate::host::{MS, Streaming};
use crate::rig::settings;
use fivebar_firmware::controller::Request;
use fivebar_firmware::motion::StreamMode;
use fivebar_firmware::planner::{MoveErrorKind, StreamPhase, StreamReason};
use fivebar_kinematics::five_bar::{Geometry, Side};

const DELAY: u32 = 25;
/// Points from one force to the other.
const RISE: u32 = 40;
/// What the tool presses with [N].
const FORCE: [f64; 2] = [1.5, -2.0];

/// The torques of a force on the tool [N·m]: the work that it does on small turns of the joints.
fn torques([theta1, theta4]: [f64; 2], [fx, fy]: [f64; 2]) -> [f64; 2] {
    let geometry = Geometry::new(settings().lengths.map(f64::from)).unwrap();
    let work = |theta1, theta4| {
        let c = geometry.forward(theta1, theta4, Side::Left).unwrap().c;
        fx * c.x + fy * c.y
    };
    let step = 1e-6;
    [
        (work(theta1 + step, theta4) - work(theta1 - step, theta4)) / (2.0 * step),
        (work(theta1, theta4 + step) - work(theta1, theta4 - step)) / (2.0 * step),
    ]
}

/// A stream that holds the arm where it is, while a force outside rises and stays, and the points have it if `knows`. Returns
/// the stream and the tool's greatest distance from its place [m].
fn pressed(mode: StreamMode, knows: bool) -> (Streaming, f64) {
    let mut stream = Streaming::begin(mode, DELAY);
    let (place, theta) = (stream.rig.bench.tool(), stream.rig.bench.theta);
    let at = match mode {
        StreamMode::Joint => theta,
        _ => place,
    };
    let all = torques(theta, FORCE);
    let mut worst = 0.0_f64;
    for ms in 0..6 * RISE {
        let share = f64::from(ms.min(RISE)) / f64::from(RISE);
        let (n, mut point) = stream.point(&|_| [at, [0.0; 2]], ms);
        let force = match mode {
            StreamMode::Joint => all,
            _ => FORCE,
        };
        if knows {
            point.force = force.map(|value| (share * value) as f32).into();
        } else {
            point.force = (f32::NAN, f32::NAN);
        }
        stream.send((n, point), 0);
        for tick in 0..MS {
            // The point is there a delay later, and the piece before it has led there.
            let passed = f64::from(ms) + f64::from(tick) / f64::from(MS) - f64::from(DELAY);
            let share = (passed / f64::from(RISE)).clamp(0.0, 1.0);
            stream.rig.bench.push = all.map(|torque| -share * torque);
            stream.tick();
            let [x, y] = stream.rig.bench.tool();
            worst = worst.max((x - place[0]).hypot(y - place[1]));
        }
    }
    assert_eq!(stream.phase(), StreamPhase::Follows);
    assert_eq!(stream.progress().reason, None);
    (stream, worst)
}

/// Nothing is pressed any more: in the mean the motors give no torque. (A count of an encoder is worth 0.1 N·m for a tick.)
fn assert_gives_nothing(stream: &mut Streaming) {
    let mut mean = [0.0; 2];
    for _ in 0..100 * MS {
        stream.tick();
        let torque = stream.rig.controller.status().torque;
        mean = [0, 1].map(|joint| mean[joint] + torque[joint] / (100 * MS) as f32);
    }
    for torque in mean {
        assert!(torque.abs() < 0.01, "{torque} N·m");
    }
}

#[test]
fn an_arm_that_is_told_what_it_presses_against_stays_where_it_is() {
    for mode in [StreamMode::Tip, StreamMode::Joint] {
        let (mut stream, told) = pressed(mode, true);
        let (_, untold) = pressed(mode, false);
        assert!(told < 0.2 * untold, "{mode:?}: {told} m, {untold} m");
        let all = torques(stream.rig.bench.theta, FORCE);
        for (given, wanted) in stream.rig.controller.status().torque.into_iter().zip(all) {
            assert!(
                (f64::from(given) - wanted).abs() < 0.01,
                "{given}, {wanted}"
            );
        }
        // The end of the stream takes the force away along its stop, and so does the other side.
        stream.rig.planner.end_stream(StreamReason::Asked);
        stream.rig.bench.push = [0.0; 2];
        stream.ticks(200 * MS);
        assert_eq!(stream.phase(), StreamPhase::Ended);
        assert!(all[0].hypot(all[1]) > 0.1, "{all:?} N·m");
        assert_gives_nothing(&mut stream);
    }
}

#[test]
fn a_stop_takes_the_force_away() {
    let (mut stream, _) = pressed(StreamMode::Tip, true);
    stream.rig.bench.push = [0.0; 2];
    stream.rig.controller.request(Request::Stop).unwrap();
    stream.ticks(300 * MS);
    assert_eq!(stream.phase(), StreamPhase::Ended);
    assert_gives_nothing(&mut stream);
}

#[test]
fn a_force_that_leaves_no_torque_for_the_motion_is_a_limit() {
    let mut stream = Streaming::begin(StreamMode::Joint, DELAY);
    let theta = stream.rig.bench.theta;
    let (n, mut point) = stream.point(&|_| [theta, [0.0; 2]], 0);
    point.force = (0.0, 1.01 * settings().peak_torque()[1]);
    stream.give((n, point));
    let limit = StreamReason::Limit(MoveErrorKind::Overload(4));
    assert_eq!(stream.progress().reason, Some(limit));
    let mut stream = Streaming::begin(StreamMode::Tip, DELAY);
    let place = stream.rig.tool_position().map(f64::from);
    let (n, mut point) = stream.point(&|_| [place, [0.0; 2]], 0);
    point.force = (f32::INFINITY, 0.0);
    stream.give((n, point));
    assert_eq!(stream.progress().reason, Some(StreamReason::Number));
}
