//! When points are due, and where they are.

use super::{SetPoint, StreamOptions, Streamer};
use fivebar_firmware::motion::{StreamMode, StreamPolicy};

const TICK_RATE: f64 = 10_000.0;

fn streamer(rate: f64, begun: u32) -> Streamer {
    let options = StreamOptions {
        mode: StreamMode::Tip,
        rate,
        delay: None,
        policy: StreamPolicy::Stop,
        fixtures: [None; 3],
    };
    Streamer::new(options.config(1, TICK_RATE), TICK_RATE, begun)
}

fn at(time: f64) -> SetPoint {
    SetPoint::at([0.1 * time, 0.02 * (3.0 * time).sin()])
}

#[test]
fn the_usual_delay_fits_the_controller() {
    for (rate, period, delay) in [
        (1000.0, 10, 260),
        (500.0, 20, 400),
        (100.0, 100, 400),
        (20.0, 500, 1500),
    ] {
        let options = StreamOptions {
            mode: StreamMode::Tip,
            rate,
            delay: None,
            policy: StreamPolicy::Stop,
            fixtures: [None; 3],
        };
        let config = options.config(1, TICK_RATE);
        assert_eq!((config.period, config.delay), (period, delay), "{rate}");
    }
    let options = StreamOptions {
        mode: StreamMode::Tip,
        rate: 1000.0,
        delay: Some(0.01),
        policy: StreamPolicy::Stop,
        fixtures: [None; 3],
    };
    assert_eq!(options.config(1, TICK_RATE).delay, 100);
}

#[test]
fn points_are_due_a_period_apart_with_the_velocity_of_their_neighbours() {
    let mut streamer = streamer(500.0, 70_000);
    assert_eq!(streamer.push(at(0.0), 70_000), None);
    let mut last = None;
    for point in 1..1000_u32 {
        let tick = 70_000 + 20 * (point - 1);
        assert!(streamer.is_due(tick) && !streamer.is_due(tick - 1));
        let (n, sent) = streamer
            .push(at(f64::from(point) * 2e-3), tick)
            .expect("a point");
        assert_eq!((u32::from(n), sent.due), (point, tick + 400));
        let time = f64::from(point - 1) * 2e-3;
        if point > 1 {
            assert!((f64::from(sent.velocity.1) - 0.06 * (3.0 * time).cos()).abs() < 1e-5);
        }
        last = Some(sent.due);
    }
    let (n, sent) = streamer.last(90_000).expect("the last point");
    assert_eq!((n, Some(sent.due - 20)), (1000, last));
    assert_eq!(streamer.last(90_000), None);
}

/// The program gives its points by a clock that is slow or fast by 100 ppm, for ten minutes.
#[test]
fn the_points_of_a_wrong_clock_stay_ahead_by_the_delay_within_a_period() {
    for error in [1e-4, -1e-4] {
        let mut streamer = streamer(1000.0, 5);
        streamer.push(at(0.0), 5);
        let (mut least, mut most) = (f64::MAX, f64::MIN);
        for point in 1..600_000_u32 {
            let given = f64::from(point - 1) * 1e-3 * (1.0 + error);
            let mut tick = 5 + (given * TICK_RATE) as u32;
            // A program that is early waits.
            while !streamer.is_due(tick) {
                tick += 1;
            }
            let time = f64::from(point) * 1e-3;
            let (_, sent) = streamer.push(at(time), tick).expect("a point");
            let ahead = f64::from(sent.due) - f64::from(tick);
            (least, most) = (least.min(ahead), most.max(ahead));
            // The point is where the motion is in its tick.
            let (x, _) = sent.position;
            assert!((f64::from(x) / 0.1 - (time - 1e-3)).abs() < 6e-5 + 3e-6 * time);
        }
        assert!(
            least >= 260.0 - 11.0 && most <= 260.0 + 10.0,
            "{least} {most}"
        );
    }
}

#[test]
fn a_stream_that_goes_on_begins_at_rest_and_comes_back_to_the_motion() {
    let mut streamer = streamer(500.0, 0);
    streamer.push(at(0.0), 0);
    let rest = [0.03, 0.01];
    streamer.go_on_from(rest, 5_000);
    let points: Vec<_> = (1..400_u32)
        .filter_map(|point| streamer.push(at(f64::from(point) * 2e-3), 5_000 + 20 * (point - 1)))
        .map(|(_, point)| point)
        .collect();
    let first = &points[0];
    assert_eq!(
        <[f32; 2]>::from(first.position),
        rest.map(|value| value as f32)
    );
    assert_eq!((first.velocity, first.due), ((0.0, 0.0), 5_400));
    let worst = points.windows(2).fold(0.0_f32, |worst, pair| {
        // The velocities are those of the positions.
        let moved = (pair[1].position.0 - pair[0].position.0) / 2e-3;
        worst.max((moved - 0.5 * (pair[0].velocity.0 + pair[1].velocity.0)).abs())
    });
    assert!(worst < 2e-3, "{worst} m/s");
    let last = points.last().expect("points");
    assert!((f64::from(last.position.0) - 0.1 * 398.0 * 2e-3).abs() < 1e-7);
}
