//! Streams of set-points to the production image: followed in both modes, and ended at a limit.

mod bench;

use bench::{Bench, arm_at, robot};
use fivebar_chip::Options;
use fivebar_chip::time::MILLISECOND;
use fivebar_firmware::motion::{StreamConfig, StreamMode, StreamPoint, StreamPolicy};
use fivebar_firmware::planner::{StreamPhase, StreamReason};
use fivebar_firmware::protocol::HostCommand;
use fivebar_firmware::safety::State;
use fivebar_sim::drive::{Drive, Given};
use fivebar_sim::streaming::{SetPoint, StreamOptions};
use std::f64::consts::PI;

/// Ticks per second.
const TICK_RATE: f64 = 10_000.0;
/// Points of a motion, at 500 a second.
const POINTS: u32 = 150;
/// Points of one that goes too far.
const MANY_POINTS: u32 = 1500;
const RADIUS: f64 = 6e-3;

/// A program that gives the places at shares from 0 to 1 of a motion that begins and ends at rest.
fn program(points: u32, mut at: impl FnMut(f64) -> [f64; 2]) -> impl FnMut() -> Given {
    let mut next = 0;
    move || {
        let share = f64::from(next) / f64::from(points);
        next += 1;
        if share > 1.0 {
            return Given::End;
        }
        let smooth = share * share * (3.0 - 2.0 * share);
        Given::Point(SetPoint::at(at(smooth)))
    }
}

/// The same, with a pause that is longer than the delay.
fn with_pause(mut next: impl FnMut() -> Given) -> impl FnMut() -> Given {
    let mut calls = 0;
    move || {
        calls += 1;
        // Time passes at each call.
        if (70..270).contains(&calls) {
            return Given::Nothing;
        }
        next()
    }
}

/// The same, with pauses of growing length: in some the arm has begun to slow down, but not come to rest.
fn with_growing_pauses(mut next: impl FnMut() -> Given) -> impl FnMut() -> Given {
    let mut calls = 0_u32;
    move || {
        calls += 1;
        let (number, within) = (calls / 30, calls % 30);
        // None in the last half second: the end would lie beside the last point.
        if number < 12 && within < 2 * number {
            return Given::Nothing;
        }
        next()
    }
}

fn options(mode: StreamMode) -> StreamOptions {
    StreamOptions {
        mode,
        rate: 500.0,
        delay: Some(0.03),
        policy: StreamPolicy::Stop,
        fixtures: [None; 3],
    }
}

#[test]
fn half_a_circle_and_the_way_back_with_a_pause_are_followed_and_a_stream_beyond_reach_ends_at_rest()
{
    let [x, y] = robot().best_point().expect("a point");
    let arm = arm_at([x as f32, y as f32], MILLISECOND);
    let mut driven = Bench::of(arm, Options::default(), Vec::new()).ready();
    driven.arm();
    let begun = driven.status().angle.map(f64::from);
    let half_circle = |share: f64| {
        let (sin, cos) = (PI * share).sin_cos();
        [x + RADIUS * sin, y + RADIUS * (1.0 - cos)]
    };
    let mut drive = Drive::new(&mut driven.client, &|| false);
    let followed = drive.follow_stream(
        &options(StreamMode::Tip),
        TICK_RATE,
        &mut program(POINTS, half_circle),
    );
    followed.expect("half a circle");
    let status = driven.status();
    let [tool_x, tool_y] = status.tool.expect("a position").map(f64::from);
    let off = (tool_x - x).hypot(tool_y - y - 2.0 * RADIUS);
    assert!(off < 5e-5 && status.fault.is_none(), "{off} m off");

    let from = status.angle.map(f64::from);
    let back = |share: f64| [0, 1].map(|joint| from[joint] + share * (begun[joint] - from[joint]));
    let mut drive = Drive::new(&mut driven.client, &|| false);
    let followed = drive.follow_stream(
        &options(StreamMode::Joint),
        TICK_RATE,
        &mut with_pause(program(3 * POINTS, back)),
    );
    followed.expect("the way back");
    let status = driven.status();
    for (angle, begun) in status.angle.into_iter().zip(begun) {
        assert!((f64::from(angle) - begun).abs() < 1e-3, "{status:?}");
    }

    let mut drive = Drive::new(&mut driven.client, &|| false);
    let followed = drive.follow_stream(
        &StreamOptions {
            rate: 100.0,
            ..options(StreamMode::Tip)
        },
        TICK_RATE,
        &mut with_growing_pauses(program(2 * POINTS, half_circle)),
    );
    followed.expect("half a circle, late again and again");
    let [tool_x, tool_y] = driven.status().tool.expect("a position").map(f64::from);
    let off = (tool_x - x).hypot(tool_y - y - 2.0 * RADIUS);
    assert!(off < 5e-5, "{off} m off");

    let away = |share: f64| [x, y + 0.4 * share];
    let mut drive = Drive::new(&mut driven.client, &|| false);
    let ended = drive.follow_stream(
        &options(StreamMode::Tip),
        TICK_RATE,
        &mut program(MANY_POINTS, away),
    );
    assert!(ended.is_err(), "no arm reaches so far");
    let status = driven.status();
    assert_eq!((status.state, status.fault), (State::Armed, None));
    let [_, tool_y] = status.tool.expect("a position").map(f64::from);
    assert!(tool_y > y + 0.005 && tool_y < y + 0.25, "{tool_y} m");
}

/// A host that draws a large circle, a part of which is out of reach, and then waits at its beginning.
#[test]
fn a_stream_that_limits_do_not_end_comes_back_to_where_it_began() {
    let [x, y] = robot().best_point().expect("a point");
    let arm = arm_at([x as f32, y as f32], MILLISECOND);
    let mut driven = Bench::of(arm, Options::default(), Vec::new()).ready();
    driven.arm();
    let circle = |share: f64| {
        let (sin, cos) = (2.0 * PI * (share / 0.7).min(1.0)).sin_cos();
        [x + 0.05 * sin, y + 0.15 * (1.0 - cos)]
    };
    let mut drive = Drive::new(&mut driven.client, &|| false);
    let followed = drive.follow_stream(
        &StreamOptions {
            policy: StreamPolicy::Limit,
            ..options(StreamMode::Tip)
        },
        TICK_RATE,
        &mut program(MANY_POINTS, circle),
    );
    followed.expect("a circle as far as the arm goes");
    let status = driven.status();
    assert_eq!((status.state, status.fault), (State::Armed, None));
    let [tool_x, tool_y] = status.tool.expect("a position").map(f64::from);
    let off = (tool_x - x).hypot(tool_y - y);
    assert!(off < 5e-5, "{off} m off");
}

#[test]
fn points_that_cannot_be_followed_are_refused_with_their_reason_and_the_third_ends_the_stream() {
    let [x, y] = robot().best_point().expect("a point");
    for mistake in 0..8 {
        let arm = arm_at([x as f32, y as f32], MILLISECOND);
        let mut driven = Bench::of(arm, Options::default(), Vec::new()).ready();
        driven.arm();
        let config = options(StreamMode::Joint).config(7, TICK_RATE);
        let begun = driven.client.command(HostCommand::BeginStream(config));
        begun.expect("an answer").expect("a stream");
        let status = driven.status();
        let [theta1, theta4] = status.angle;
        let right = StreamPoint {
            id: 7,
            due: status.tick + 400,
            position: (theta1, theta4),
            velocity: (0.0, 0.0),
            force: (0.0, 0.0),
        };
        let wrong = match mistake {
            0 => StreamPoint {
                velocity: (f32::NAN, 0.0),
                force: (0.0, 0.0),
                ..right
            },
            1 => StreamPoint {
                due: status.tick,
                ..right
            },
            2 => StreamPoint {
                due: status.tick + 5_000,
                ..right
            },
            3 => StreamPoint {
                position: (theta1 + 0.1, theta4),
                ..right
            },
            4 => StreamPoint { id: 8, ..right },
            5 => right,
            6 => StreamPoint {
                due: right.due + 900,
                ..right
            },
            _ => StreamPoint {
                due: right.due + 20,
                position: (theta1 + 0.3, theta4),
                ..right
            },
        };
        if mistake > 4 {
            driven.client.send_point(0, &right).expect("the line");
            driven.run(5 * MILLISECOND);
        }
        for n in 1..=3 {
            driven.client.send_point(n, &wrong).expect("the line");
            driven.run(5 * MILLISECOND);
        }
        driven.status();
        let states = core::iter::from_fn(|| driven.client.take_stream_state());
        let last = states.last().expect("a state").progress;
        let is_expected = match last.reason {
            Some(StreamReason::Number) => mistake == 0,
            Some(StreamReason::Late) => mistake == 1,
            Some(StreamReason::Early) => mistake == 2,
            Some(StreamReason::Away(_)) => mistake == 3,
            None => mistake == 4,
            Some(StreamReason::Order) => mistake == 5,
            Some(StreamReason::Gap) => mistake == 6,
            Some(StreamReason::Limit(_)) => mistake == 7,
            _ => false,
        };
        assert!(is_expected, "{mistake}: {last:?}");
        let has_ended = matches!(last.phase, StreamPhase::Ends | StreamPhase::Ended);
        assert_eq!(
            has_ended,
            ![1, 3, 4].contains(&mistake),
            "{mistake}: {last:?}"
        );
        assert_eq!(driven.status().fault, None);
    }
}

/// Behind an adapter that collects what a computer sends, or a program that stalls, 20 points come without a pause: more bytes
/// than the receiver's ring holds, and faster than the planner follows them.
#[test]
fn points_that_come_in_bursts_are_all_followed() {
    const PERIOD: u16 = 20;
    const BURST: u16 = 20;
    const BURSTS: u16 = 15;
    let [x, y] = robot().best_point().expect("a point");
    let arm = arm_at([x as f32, y as f32], MILLISECOND);
    let mut driven = Bench::of(arm, Options::default(), Vec::new()).ready();
    driven.arm();
    let config = StreamConfig {
        id: 7,
        mode: StreamMode::Tip,
        period: PERIOD,
        delay: 26 * PERIOD,
        policy: StreamPolicy::Stop,
    };
    let begun = driven.client.command(HostCommand::BeginStream(config));
    begun.expect("an answer").expect("a stream");
    let status = driven.status();
    let [x, y] = status.reference.expect("the tool's place");
    let first = status.tick + 120;
    for n in 0..BURST * BURSTS {
        if n % BURST == 0 && n > 0 {
            driven.run(u64::from(BURST * PERIOD) * MILLISECOND / 10);
        }
        let share = f32::from(n) / f32::from(BURST * BURSTS - 1);
        let way = 0.02 * share * share * (3.0 - 2.0 * share);
        let speed = 0.12 * share * (1.0 - share) * 500.0 / f32::from(BURST * BURSTS - 1);
        let point = StreamPoint {
            id: 7,
            due: first + u32::from(PERIOD) * u32::from(n),
            position: (x + way, y),
            velocity: (speed, 0.0),
            force: (0.0, 0.0),
        };
        driven.client.send_point(n, &point).expect("the line");
    }
    let ended = driven.client.command(HostCommand::EndStream);
    ended.expect("an answer").expect("the end");
    driven.run(100 * MILLISECOND);
    driven.status();
    let states = core::iter::from_fn(|| driven.client.take_stream_state());
    let last = states.last().expect("a state").progress;
    assert_eq!(last.last, Some(BURST * BURSTS - 1), "{last:?}");
    assert_eq!([last.late, last.lost, last.refused], [0; 3], "{last:?}");
}
