//! Streams of set-points to the production image: followed in both modes, and ended at a limit.

mod bench;

use bench::{Bench, arm_at, robot};
use fivebar_chip::Options;
use fivebar_chip::time::MILLISECOND;
use fivebar_firmware::motion::StreamMode;
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
        Given::Point(SetPoint {
            position: at(smooth),
            velocity: None,
        })
    }
}

fn options(mode: StreamMode) -> StreamOptions {
    StreamOptions {
        mode,
        rate: 500.0,
        delay: Some(0.03),
    }
}

#[test]
fn half_a_circle_and_the_way_back_are_followed_and_a_stream_beyond_reach_ends_at_rest() {
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
        &mut program(POINTS, back),
    );
    followed.expect("the way back");
    let status = driven.status();
    for (angle, begun) in status.angle.into_iter().zip(begun) {
        assert!((f64::from(angle) - begun).abs() < 1e-3, "{status:?}");
    }

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
