//! Motion out of the look-ahead: continuous, within its limits, within the corner
//! tolerance, ending where it should.

use fivebar_kinematics::Vec2;
use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
use fivebar_kinematics::trajectory::{
    Caps, Envelope, JointLimits, LookAhead, Piece, Reference, Segment,
};
use proptest::prelude::*;

type V = Vec2<f64>;

fn envelope(corner_tolerance: f64) -> Envelope<f64> {
    let joint = JointLimits {
        angles: [-10.0, 10.0],
        speed: 100.0,
        acceleration: 10_000.0,
    };
    Envelope {
        geometry: Geometry::new([0.23, 0.23, 0.23, 0.23, 0.275]).unwrap(),
        mode: WorkingMode::new(Side::Right, Side::Left),
        singularity_margin: 0.05,
        joints: [joint; 2],
        tool: Caps {
            speed: 0.3,
            acceleration: 5.0,
            jerk: 500.0,
        },
        corner_tolerance,
        torque: None,
    }
}

fn tool(piece: &Piece<f64>, t: f64) -> (V, V, V) {
    match piece.evaluate(t) {
        Reference::Tool {
            position,
            velocity,
            acceleration,
        } => (position, velocity, acceleration),
        Reference::Joint { .. } => panic!("a path moves the tool"),
    }
}

/// Runs a polyline through the look-ahead, as full a queue as it allows.
fn run(points: &[V], feed: f64, envelope: &Envelope<f64>) -> Vec<Piece<f64>> {
    let mut look_ahead = LookAhead::<f64, 32>::new();
    let mut pieces = Vec::new();
    for (tag, ends) in points.windows(2).enumerate() {
        let Ok(segment) = Segment::line(ends[0], ends[1]) else {
            continue;
        };
        let caps = envelope.admit(&segment, feed).unwrap();
        while !look_ahead.has_room() {
            pieces.push(look_ahead.next_piece().unwrap());
        }
        look_ahead
            .push(&segment, caps, tag as u32, envelope)
            .unwrap();
    }
    while let Some(piece) = look_ahead.next_piece() {
        pieces.push(piece);
    }
    assert!(look_ahead.is_empty());
    pieces
}

fn assert_sound(pieces: &[Piece<f64>], start: V, end: V, limits: &Caps<f64>) -> f64 {
    let mut last = (start, V::zero(), V::zero());
    let mut time = 0.0;
    for (index, piece) in pieces.iter().enumerate() {
        let first = tool(piece, 0.0);
        assert!((first.0 - last.0).norm() < 1e-9, "place at {index}");
        assert!((first.1 - last.1).norm() < 1e-7, "velocity at {index}");
        assert!(
            (first.2 - last.2).norm() < 1e-4 * limits.acceleration,
            "acceleration at {index}: {first:?} after {last:?}"
        );
        let steps = 12;
        let dt = piece.duration() / f64::from(steps);
        let mut before = first;
        for step in 1..=steps {
            let now = tool(piece, dt * f64::from(step));
            assert!(now.1.norm() <= limits.speed * (1.0 + 1e-9));
            assert!(now.2.norm() <= limits.acceleration * (1.0 + 1e-9));
            assert!((now.2 - before.2).norm() <= limits.jerk * dt * (1.0 + 1e-6) + 1e-9);
            before = now;
        }
        last = tool(piece, piece.duration());
        time += piece.duration();
    }
    assert!((last.0 - end).norm() < 1e-9);
    assert!(last.1.norm() < 1e-9 && last.2.norm() < 1e-6);
    time
}

proptest! {
    #[test]
    fn polylines_are_followed_within_all_limits(
        steps in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, -4.0..-1.0_f64), 1..80),
        tolerance in prop::sample::select(vec![0.0, 1e-5, 1e-4]),
        feed in 0.01..0.3_f64,
    ) {
        let envelope = envelope(tolerance);
        let mut points = vec![V::new(0.1, 0.3)];
        for (x, y, exponent) in steps {
            let last = *points.last().unwrap();
            points.push(last + V::new(x, y) * 10f64.powf(exponent));
        }
        let pieces = run(&points, feed, &envelope);
        let limits = Caps { speed: feed, ..envelope.tool };
        assert_sound(&pieces, points[0], *points.last().unwrap(), &limits);
    }
}

#[test]
fn a_fine_polyline_is_passed_at_full_speed() {
    let envelope = envelope(5e-5);
    let points: Vec<V> = (0..1000)
        .map(|i| {
            let angle = f64::from(i) * 0.005;
            V::new(0.1, 0.3) + V::unit(angle) * 0.04
        })
        .collect();
    let pieces = run(&points, 0.058, &envelope);
    let limits = Caps {
        speed: 0.058,
        ..envelope.tool
    };
    let time = assert_sound(&pieces, points[0], points[999], &limits);
    let ideal = 0.04 * 0.005 * 999.0 / 0.058;
    assert!(time < ideal * 1.02, "{time} s instead of {ideal} s");
}
