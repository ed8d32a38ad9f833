//! Motion out of the look-ahead: continuous, within its limits, within the corner
//! tolerance, ending where it should.

use crate::common::{MIDDLE, Rounding, V, assert_sound, distance_to, envelope, run, tool};
use fivebar_kinematics::trajectory::{Caps, LookAhead, Segment, Sense};
use proptest::prelude::*;

const DOUBLE: Rounding = Rounding {
    position: 1e-9,
    velocity: 1e-9,
    acceleration: 1e-6,
};

/// Lines and arcs from corner to corner, from micrometres to decimetres, all within 60 mm
/// of the middle.
fn paths() -> impl Strategy<Value = Vec<Segment<f64>>> {
    let step = (
        -1.0..1.0_f64,
        -1.0..1.0_f64,
        -5.0..-1.0_f64,
        -3.0..3.0_f64,
        any::<bool>(),
    );
    prop::collection::vec(step, 1..60).prop_map(|steps| {
        let middle = V::new(MIDDLE[0], MIDDLE[1]);
        let mut from = middle;
        let mut segments = Vec::new();
        for (x, y, exponent, bulge, line) in steps {
            let mut to = from + V::new(x, y) * 10_f64.powf(exponent);
            if (to - middle).norm() > 0.06 {
                to = middle + (to - middle) * (0.06 / (to - middle).norm());
            }
            let chord = to - from;
            let centre = from + chord * 0.5 + chord.perp() * bulge;
            let radius = (centre - from).norm();
            let arc = Segment::arc(from, to, centre, Sense::Clockwise, 1e-9);
            let fits = (centre - middle).norm() + radius < 0.07;
            let segment = match arc {
                Ok(arc) if fits && !line => Ok(arc),
                _ => Segment::line(from, to),
            };
            if let Ok(segment) = segment {
                segments.push(segment);
                from = to;
            }
        }
        segments
    })
}

proptest! {
    #[test]
    fn paths_are_followed_within_all_limits_and_the_tolerance(
        segments in paths(),
        tolerance in prop::sample::select(vec![0.0, 1e-5, 1e-4]),
        feed in 0.01..0.3_f64,
    ) {
        prop_assume!(!segments.is_empty());
        let envelope = envelope(tolerance);
        let pieces = run(&segments, feed, &envelope);
        let limits = Caps { speed: feed, ..envelope.tool_motion };
        let ends = [segments[0].start(), segments.last().unwrap().end()];
        assert_sound(&pieces, ends, &limits, &DOUBLE);

        // Everything moved through is on the path, and all of the path is moved through.
        let mut reached = vec![false; segments.len()];
        for piece in &pieces {
            let tag = piece.tag() as usize;
            reached[tag] = true;
            for step in 0..=6 {
                let position = tool(piece, piece.duration() * f64::from(step) / 6.0).0;
                let mut distance = distance_to(&segments[tag], position);
                // A blend carries the name of the segment that it leads into.
                if distance > tolerance && tag > 0 {
                    distance = distance.min(distance_to(&segments[tag - 1], position));
                }
                prop_assert!(distance <= tolerance + 1e-9, "{distance} m off segment {tag}");
            }
        }
        prop_assert!(reached.iter().all(|&reached| reached));
    }
}

#[test]
fn a_fine_polyline_is_passed_at_full_speed() {
    let envelope = envelope(5e-5);
    let points: Vec<V> = (0..1000)
        .map(|i| V::new(MIDDLE[0], MIDDLE[1]) + V::unit(f64::from(i) * 0.005) * 0.04)
        .collect();
    let segments: Vec<_> = points
        .windows(2)
        .map(|ends| Segment::line(ends[0], ends[1]).unwrap())
        .collect();
    let pieces = run(&segments, 0.058, &envelope);
    let limits = Caps {
        speed: 0.058,
        ..envelope.tool_motion
    };
    let time = assert_sound(&pieces, [points[0], points[999]], &limits, &DOUBLE);
    let ideal = 0.04 * 0.005 * 999.0 / 0.058;
    assert!(time < ideal * 1.02, "{time} s instead of {ideal} s");
}

#[test]
fn corners_without_tolerance_are_stopped_at() {
    let envelope = envelope(0.0);
    let [a, b, c] = [[0.10, 0.30], [0.15, 0.30], [0.15, 0.33]].map(|[x, y]| V::new(x, y));
    let segments = [Segment::line(a, b).unwrap(), Segment::line(b, c).unwrap()];
    let pieces = run(&segments, 0.1, &envelope);
    let stop = pieces.iter().find(|piece| piece.tag() == 1).unwrap();
    let (position, velocity, acceleration) = tool(stop, 0.0);
    assert!((position - b).norm() < 1e-15);
    assert_eq!((velocity, acceleration), (V::zero(), V::zero()));
}

#[test]
fn a_queue_that_runs_dry_ends_at_rest_and_goes_on() {
    let envelope = envelope(1e-4);
    let mut look_ahead = LookAhead::<f64, 16>::new();
    let points = [[0.10, 0.30], [0.15, 0.30], [0.15, 0.33]].map(|[x, y]| V::new(x, y));
    for (tag, ends) in points.windows(2).enumerate() {
        let line = Segment::line(ends[0], ends[1]).unwrap();
        let caps = envelope.admit(&line, 0.1).unwrap();
        look_ahead.push(&line, caps, tag as u32, &envelope).unwrap();
        let mut last = None;
        while let Some(piece) = look_ahead.next_piece() {
            last = Some(tool(&piece, piece.duration()));
        }
        let (position, velocity, acceleration) = last.unwrap();
        assert!((position - ends[1]).norm() < 1e-12);
        assert!(velocity.norm() < 1e-9 && acceleration.norm() < 1e-6);
    }
}
