//! What the controller does with each kind of point and of silence: a test for each row of the table in `docs/use/streaming.md`.

use crate::host::{ID, MS, Motion, Streaming, sine};
use crate::rig::{Rig, START, settings, with};
use fivebar_firmware::MoveKind;
use fivebar_firmware::controller::Request;
use fivebar_firmware::motion::{StreamConfig, StreamMode, StreamPoint, StreamPolicy};
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::planner::{StreamError, StreamPhase, StreamReason};
use fivebar_firmware::safety::{Fault, State};

/// The delay of the streams [ms].
const DELAY: u32 = 25;

/// A stream of a sine about where the tool is, which has followed so many milliseconds of it.
fn followed(ms: u32) -> (Streaming, impl Fn(f64) -> [[f64; 2]; 2]) {
    let mut stream = Streaming::begin(StreamMode::Tip, DELAY);
    let motion = sine(stream.rig.tool_position());
    follow(&mut stream, &motion, 0..ms);
    assert_eq!(stream.progress().reason, None);
    (stream, motion)
}

/// Gives the points of these milliseconds in time.
fn follow(stream: &mut Streaming, motion: Motion<'_>, ms: std::ops::Range<u32>) {
    for ms in ms {
        let point = stream.point(motion, ms);
        stream.give(point);
        stream.ticks(MS);
    }
}

/// The counts of late, lost and refused points.
fn counts(stream: &Streaming) -> [u16; 3] {
    let progress = stream.progress();
    [progress.late, progress.lost, progress.refused]
}

/// Ticks with signs of life until the arm rests; the phase of the stream then.
fn until_rest(stream: &mut Streaming) -> StreamPhase {
    for _ in 0..500 * MS {
        stream.rig.controller.feed_host_timeout();
        stream.tick();
        if stream.rig.controller.state() == State::Armed {
            break;
        }
    }
    stream.tick();
    assert_eq!(stream.rig.controller.state(), State::Armed);
    stream.phase()
}

#[test]
fn a_point_that_was_due_is_dropped_and_counted_late() {
    let (mut stream, motion) = followed(100);
    let (n, mut point) = stream.point(&motion, 100);
    point.due = stream.rig.controller.ticks();
    stream.give((n, point));
    assert_eq!(counts(&stream), [1, 0, 0]);
    assert_eq!(stream.progress().reason, Some(StreamReason::Late));
    assert_eq!(stream.phase(), StreamPhase::Follows);
}

#[test]
fn lost_points_are_bridged_and_counted() {
    let (mut stream, motion) = followed(100);
    let mut worst = 0.0_f64;
    for ms in 100..300 {
        let point = stream.point(&motion, ms);
        if ms % 10 > 4 {
            stream.give(point);
        }
        stream.ticks(MS);
        let [x, _] = stream
            .rig
            .controller
            .status()
            .reference
            .expect("a reference");
        let [[xd, _], _] = motion(f64::from(ms + 1 - DELAY) * 1e-3 - 1.0 / 3500.0);
        worst = worst.max((f64::from(x) - xd).abs());
    }
    assert_eq!(counts(&stream), [0, 100, 0]);
    assert!(worst < 2e-6, "{worst}");
}

#[test]
fn a_dry_stream_nearly_keeps_its_velocity_for_two_periods_then_stops_without_a_fault() {
    let (mut stream, _) = followed(100);
    let at_end = stream.begun + 99 * MS + DELAY * MS;
    while stream.rig.controller.ticks() < at_end {
        stream.rig.controller.feed_host_timeout();
        stream.tick();
    }
    let velocity = |stream: &Streaming| {
        stream
            .rig
            .controller
            .status()
            .joint_reference
            .expect("one")
            .velocity
    };
    let kept = velocity(&stream);
    for tick in 1..=2 * MS {
        stream.rig.controller.feed_host_timeout();
        stream.tick();
        let share = velocity(&stream)[0] / kept[0];
        let least = if tick <= MS { 0.985 } else { 0.94 };
        assert!((least..1.01).contains(&share), "{tick}: {share}");
    }
    stream.ticks(2);
    assert_eq!(stream.phase(), StreamPhase::Starved);
    assert_eq!(until_rest(&mut stream), StreamPhase::Starved);
    assert_eq!(stream.rig.controller.status().fault, None);
}

#[test]
fn a_starved_stream_goes_on_by_a_point_near_the_arm() {
    let (mut stream, motion) = followed(100);
    until_rest(&mut stream);
    // The sine is elsewhere by now.
    let away = stream.now();
    let point = stream.point(&motion, away);
    stream.give(point);
    let Some(StreamReason::Away(distance)) = stream.progress().reason else {
        panic!("{:?}", stream.progress());
    };
    let [x, y] = stream.rig.tool_position();
    let (px, py) = point.1.position;
    assert!(
        ((px - x).hypot(py - y) - distance).abs() < 1e-6,
        "{distance}"
    );
    assert_eq!(stream.phase(), StreamPhase::Starved);
    // From rest at the arm it goes on.
    let begins = f64::from(stream.now()) * 1e-3;
    let from = sine([x, y]);
    let again = move |t: f64| from(t - begins);
    let now = stream.now();
    follow(&mut stream, &again, now..now + 200);
    assert_eq!(stream.phase(), StreamPhase::Follows);
    assert_eq!(stream.rig.controller.status().fault, None);
}

#[test]
fn a_gap_shorter_than_the_coast_is_passed_without_a_rest() {
    let (mut stream, motion) = followed(100);
    // The points of 24 ms are lost: the last one is due now, and the arm keeps its velocity for a millisecond.
    for _ in 0..24 {
        stream.point(&motion, 0);
        stream.ticks(MS);
    }
    follow(&mut stream, &motion, 124..200);
    assert_eq!(counts(&stream), [0, 24, 0], "{:?}", stream.progress());
    assert_eq!(stream.phase(), StreamPhase::Follows);
}

#[test]
fn a_host_that_is_silent_for_the_command_timeout_has_fault_12() {
    for (silence, fault) in [(95, None), (150, Some(Fault::CommandTimeout))] {
        let (mut stream, _) = followed(100);
        stream.ticks(silence * MS);
        assert_eq!(stream.rig.controller.status().fault, fault, "{silence} ms");
    }
    // Also of an arm that rests before its first point.
    let mut stream = Streaming::begin(StreamMode::Joint, DELAY);
    stream.ticks(150 * MS);
    assert_eq!(
        stream.rig.controller.status().fault,
        Some(Fault::CommandTimeout)
    );
    assert_eq!(stream.phase(), StreamPhase::Ended);
    assert_eq!(Fault::CommandTimeout.number(), 12);
}

#[test]
fn wrong_points_are_refused_with_the_reason_and_three_in_a_row_end_the_stream() {
    type Change = fn(&mut Streaming, &mut (u16, StreamPoint));
    let changes: [(StreamReason, Change); 6] = [
        (StreamReason::Number, |_, (_, point)| {
            point.position.1 = f32::NAN;
        }),
        (StreamReason::Number, |_, (_, point)| {
            point.velocity.0 = f32::INFINITY;
        }),
        (StreamReason::Early, |stream, (_, point)| {
            point.due = stream.rig.controller.ticks() + 251 * MS;
        }),
        (StreamReason::Order, |_, (_, point)| point.due -= MS),
        (StreamReason::Order, |_, (n, _)| *n -= 1),
        (StreamReason::Gap, |_, (_, point)| point.due += 26 * MS),
    ];
    for (reason, change) in changes {
        let (mut stream, motion) = followed(100);
        for (row, good) in [(2, true), (3, false)] {
            for wrong in 0..row {
                let ms = stream.now();
                let mut point = stream.point(&motion, ms);
                change(&mut stream, &mut point);
                // What is repeated or due before stays that.
                stream.n -= 1;
                stream.give(point);
                let found = stream.progress();
                assert_eq!(found.reason, Some(reason), "{wrong}");
                assert!(found.last < Some(point.0) || reason == StreamReason::Order);
            }
            let ms = stream.now();
            let point = stream.point(&motion, ms);
            stream.give(point);
            let phase = [StreamPhase::Ends, StreamPhase::Follows][usize::from(good)];
            assert_eq!(stream.phase(), phase, "{reason:?}");
            stream.ticks(MS);
        }
        assert_eq!(counts(&stream), [0, 0, 5], "{reason:?}");
        assert_eq!(until_rest(&mut stream), StreamPhase::Ended);
    }
}

#[test]
fn points_faster_than_the_period_are_refused_when_there_is_no_room() {
    let (mut stream, motion) = followed(100);
    // Ten times as many as were said.
    let mut reason = None;
    for n in 0..60 {
        let (number, mut point) = stream.point(&motion, 100);
        point.due = stream.begun + (99 + DELAY) * MS + 1 + n;
        let [position, velocity] = motion(0.099 + f64::from(n + 1) * 1e-4);
        point.position = position.map(|value| value as f32).into();
        point.velocity = velocity.map(|value| value as f32).into();
        stream.give((number, point));
        reason = reason.or(stream.progress().reason);
    }
    assert_eq!(reason, Some(StreamReason::Full));
}

#[test]
fn the_arm_stops_before_a_point_beyond_a_limit() {
    // Out over a joint's limit, then over a leg's singularity.
    let narrow = with(|settings| settings.axes[0].angle_limits = [START[0] - 0.2, START[0] + 0.2]);
    for (settings, mode, kind) in [
        (narrow, StreamMode::Joint, MoveErrorKind::JointLimit(1)),
        (
            settings(),
            StreamMode::Tip,
            MoveErrorKind::LegSingularity(1),
        ),
    ] {
        let mut stream = Streaming::with(&settings, mode, DELAY);
        let [x, y] = stream.rig.tool_position().map(f64::from);
        // 0.3 rad/s or m/s after 0.2 s.
        let speed = |t: f64| 0.3 * (t / 0.2).min(1.0);
        let way = |t: f64| {
            if t < 0.2 {
                0.75 * t * t
            } else {
                0.03 + 0.3 * (t - 0.2)
            }
        };
        let motion = |t: f64| match mode {
            StreamMode::Joint => [
                [f64::from(START[0]) + way(t), f64::from(START[1])],
                [speed(t), 0.0],
            ],
            StreamMode::Tip | StreamMode::Free | StreamMode::Impedance(_) => {
                [[x, y + way(t)], [0.0, speed(t)]]
            }
        };
        for ms in 0..2000 {
            if stream.phase() == StreamPhase::Ends {
                break;
            }
            follow(&mut stream, &motion, ms..ms + 1);
        }
        assert_eq!(stream.progress().reason, Some(StreamReason::Limit(kind)));
        let last = stream.progress().last.expect("points were taken");
        assert!(last > 100 && last + 1 == stream.n, "{last} {}", stream.n);
        assert_eq!(until_rest(&mut stream), StreamPhase::Ended);
        assert_eq!(stream.rig.controller.status().fault, None);
    }
}

#[test]
fn a_turn_more_of_a_joint_is_another_place() {
    let wide = with(|settings| settings.axes[0].angle_limits = [-6.0, 6.0]);
    let mut stream = Streaming::with(&wide, StreamMode::Joint, DELAY);
    let there = START.map(f64::from);
    let rests = move |_: f64| [there, [0.0; 2]];
    follow(&mut stream, &rests, 0..50);
    assert_eq!(stream.phase(), StreamPhase::Follows);
    let turned = move |_: f64| [[there[0] - std::f64::consts::TAU, there[1]], [0.0; 2]];
    follow(&mut stream, &turned, 50..51);
    assert_eq!(
        stream.progress().reason,
        Some(StreamReason::Limit(MoveErrorKind::JointLimit(1)))
    );
}

#[test]
fn a_stream_begins_only_where_the_arm_rests_with_a_delay_that_fits() {
    let config = |period, delay| StreamConfig {
        id: ID,
        mode: StreamMode::Tip,
        period,
        delay,
        policy: StreamPolicy::Stop,
    };
    let mut rig = Rig::new(&settings());
    let begin = |rig: &mut Rig, config| rig.planner.begin_stream(&mut rig.controller, &config);
    assert_eq!(
        begin(&mut rig, config(10, 250)),
        Err(StreamError::State(State::Stopped))
    );
    rig.controller.request(Request::SetAngles(START)).unwrap();
    rig.controller.request(Request::Arm).unwrap();
    // The bridges wake up.
    assert_eq!(begin(&mut rig, config(10, 250)), Err(StreamError::Moving));
    rig.run(40);
    for (period, delay) in [
        (0, 250),
        (10, 9),
        (10, 19),
        (10, 270),
        (100, 2001),
        (100, 90),
    ] {
        assert_eq!(
            begin(&mut rig, config(period, delay)),
            Err(StreamError::Rate),
            "{period} {delay}"
        );
    }
    for (period, delay) in [(10, 20), (10, 260), (100, 2000)] {
        let mut rig = Rig::armed(&settings());
        assert_eq!(
            begin(&mut rig, config(period, delay)),
            Ok(()),
            "{period} {delay}"
        );
        assert_eq!(
            begin(&mut rig, config(period, delay)),
            Err(StreamError::Moving)
        );
        // The arm is the stream's.
        let [x, y] = rig.tool_position();
        let line = MoveKind::Line {
            to: [x + 0.01, y],
            feed: 0.1,
        };
        let refused = rig.push(1, line).map_err(|error| error.kind);
        assert_eq!(refused, Err(MoveErrorKind::Streaming));
        rig.planner.end_stream(StreamReason::Asked);
        rig.run(1);
        assert_eq!(rig.push(1, line), Ok(()));
        assert_eq!(
            begin(&mut rig, config(period, delay)),
            Err(StreamError::Moving)
        );
    }
}

#[test]
fn the_points_of_another_stream_are_not_taken() {
    let (mut stream, motion) = followed(100);
    let (n, mut point) = stream.point(&motion, 100);
    point.id += 1;
    let before = stream.progress();
    stream.give((n, point));
    assert_eq!(stream.progress(), before);
}

#[test]
fn a_stop_and_an_emergency_stop_end_the_stream() {
    let (mut stream, motion) = followed(100);
    stream.rig.controller.request(Request::Stop).unwrap();
    follow(&mut stream, &motion, 100..300);
    assert_eq!(stream.phase(), StreamPhase::Ended);
    assert_eq!(stream.progress().reason, Some(StreamReason::Stopped));
    assert_eq!(stream.rig.controller.state(), State::Armed);

    let (mut stream, _) = followed(100);
    stream
        .rig
        .controller
        .request(Request::EmergencyStop)
        .unwrap();
    stream.tick();
    let command = stream.rig.tick_alone();
    assert_eq!(command.enable, [false; 2]);
    assert_eq!(stream.phase(), StreamPhase::Ended);
    assert_eq!(
        stream.rig.controller.status().fault,
        Some(Fault::EmergencyStop)
    );
}

#[test]
fn moves_go_on_where_a_stream_has_ended() {
    let (mut stream, _) = followed(150);
    stream.rig.planner.end_stream(StreamReason::Asked);
    assert_eq!(until_rest(&mut stream), StreamPhase::Ended);
    assert_eq!(stream.progress().reason, Some(StreamReason::Asked));
    let rig = &mut stream.rig;
    let [x, y] = rig.tool_position();
    rig.push(
        1,
        MoveKind::Line {
            to: [x + 0.01, y],
            feed: 0.1,
        },
    )
    .unwrap();
    rig.run(5000);
    assert_eq!(rig.controller.status().fault, None);
    let [ex, ey] = rig.tool_position();
    assert!((ex - x - 0.01).hypot(ey - y) < 1e-5, "{ex} {ey}");
}

/// Behind a pause the arm cannot make up for its way within the two milliseconds to the next point: that one is late, and the
/// one behind it gives time enough.
#[test]
fn a_point_that_leaves_too_little_time_after_a_pause_is_late() {
    let (mut stream, motion) = followed(200);
    // The last point is passed by half a millisecond.
    stream.ticks((DELAY - 1) * MS + MS / 2);
    let late = counts(&stream)[0];
    let now = stream.now();
    let (n, mut point) = stream.point(&motion, now + 2 - DELAY);
    // A millimetre farther than the motion is.
    point.position.0 += 1e-3;
    stream.give((n, point));
    assert_eq!(counts(&stream)[0], late + 1);
    assert_eq!(stream.progress().reason, Some(StreamReason::Late));
    assert_eq!(stream.phase(), StreamPhase::Follows);
}
