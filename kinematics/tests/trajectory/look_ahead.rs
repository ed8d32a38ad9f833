//! Motion out of the look-ahead: continuous, within its limits, within the corner
//! tolerance, ending where it should.

use crate::common::{MIDDLE, Rounding, V, assert_sound, distance_to, envelope, run, tool};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::trajectory::{Caps, Curve, LookAhead, Piece, Reference, Segment, Sense};
use nalgebra::Vector2;
use proptest::prelude::*;

const DOUBLE: Rounding = Rounding {
    position: 1e-9,
    velocity: 1e-8,
    acceleration: 1e-6,
};

const SINGLE: Rounding = Rounding {
    position: 1e-6,
    velocity: 1e-4,
    acceleration: 0.1,
};

/// Lines and arcs from corner to corner, from 10^`finest` m to decimetres, all within 60 mm
/// of the middle.
fn paths(finest: f64) -> impl Strategy<Value = Vec<Segment<f64>>> {
    let step = (
        -1.0..1.0_f64,
        -1.0..1.0_f64,
        finest..-1.0,
        -3.0..3.0_f64,
        any::<bool>(),
    );
    prop::collection::vec(step, 1..30).prop_map(|steps| {
        let middle = V::new(MIDDLE[0], MIDDLE[1]);
        let mut from = middle;
        let mut segments = Vec::new();
        for (x, y, exponent, bulge, line) in steps {
            let mut to = from + V::new(x, y) * 10_f64.powf(exponent);
            if (to - middle).norm() > 0.06 {
                to = middle + (to - middle) * (0.06 / (to - middle).norm());
            }
            let chord = to - from;
            let centre = from + chord * 0.5 + chord.perpendicular() * bulge;
            let radius = (centre - from).norm();
            let arc = Segment::arc(from, to, centre, Sense::Clockwise, 1e-9);
            let fits = (centre - middle).norm() + radius < 0.07;
            segments.push(if fits && !line {
                arc.unwrap()
            } else {
                Segment::line(from, to).unwrap()
            });
            from = to;
        }
        segments
    })
}

proptest! {
    #[test]
    fn paths_are_followed_within_all_limits_and_the_tolerance(
        segments in paths(-5.0),
        tolerance in prop::sample::select(vec![0.0, 1e-5, 1e-4]),
        feed in 0.01..0.3_f64,
    ) {
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

    /// The queue may run dry, be topped up or be left alone at any moment.
    #[test]
    fn moves_that_come_late_are_joined_to_the_motion_at_hand(
        segments in paths(-5.0),
        // Pieces taken before each push.
        haste in prop::collection::vec(0..9_usize, 30),
        feed in 0.01..0.3_f64,
    ) {
        let envelope = envelope(1e-4);
        let mut look_ahead = LookAhead::<f64, 16>::new();
        let mut pieces = Vec::new();
        for ((tag, segment), haste) in segments.iter().enumerate().zip(haste) {
            let before = pieces.len() + haste;
            while pieces.len() < before || look_ahead.room() == 0 {
                let Some(piece) = look_ahead.next_piece() else { break };
                pieces.push(piece);
            }
            let caps = envelope.admit(segment, feed).unwrap();
            look_ahead.push(segment, caps, tag as u32, &envelope).unwrap();
        }
        while let Some(piece) = look_ahead.next_piece() {
            pieces.push(piece);
        }
        let limits = Caps { speed: feed, ..envelope.tool_motion };
        let ends = [segments[0].start(), segments.last().unwrap().end()];
        assert_sound(&pieces, ends, &limits, &DOUBLE);
    }

    /// In single precision the same path is followed, to a micrometre.
    #[test]
    fn single_precision_follows_the_same_path(
        segments in paths(-4.0),
        feed in 0.01..0.3_f64,
    ) {
        const TOLERANCE: f64 = 5e-5;
        let single: Vec<Segment<f32>> = segments.iter().map(narrow).collect();
        let envelope = envelope::<f32>(TOLERANCE);
        let pieces = run(&single, feed as f32, &envelope);
        let limits = Caps { speed: feed, acceleration: 5.0, jerk: 500.0 };
        let ends = [segments[0].start(), segments.last().unwrap().end()];
        let single_time = assert_sound(&pieces, ends, &limits, &SINGLE);
        for piece in &pieces {
            let tag = piece.tag() as usize;
            for step in 0..=4_u8 {
                let position = tool(piece, piece.duration() * f32::from(step) / 4.0).0;
                let mut distance = distance_to(&segments[tag], position);
                if tag > 0 {
                    distance = distance.min(distance_to(&segments[tag - 1], position));
                }
                prop_assert!(distance <= TOLERANCE + 1e-6, "{distance} m off segment {tag}");
            }
        }
        let double = run(&segments, feed, &crate::common::envelope(TOLERANCE));
        let double_time: f64 = double.iter().map(Piece::duration).sum();
        prop_assert!((single_time / double_time - 1.0).abs() < 0.05, "{single_time} s, {double_time} s");
    }

    /// v = σ p′ and a = σ² p″ + σ̇ p′ are the derivatives of p(τ(t)) with τ̇ = σ.
    #[test]
    fn a_slowed_clock_gives_the_derivatives_of_the_slowed_motion(
        segments in paths(-5.0), at in 0.1..0.9_f64, rate in 0.0..1.0_f64, slope in -30.0..30.0_f64,
    ) {
        let pieces = run(&segments, 0.2, &envelope(1e-4));
        let piece = pieces[((pieces.len() - 1) as f64 * at) as usize];
        let tau = piece.duration() * at;
        let dt = 1e-6;
        let place = |t: f64| tool(&piece, tau + (rate + 0.5 * slope * t) * t).0;
        let (before, now, after) = (place(-dt), place(0.0), place(dt));
        let Reference::Tool { position, velocity, acceleration } =
            piece.reference(piece.progress(tau).clocked(rate, slope)) else { panic!() };
        prop_assert_eq!(position, now);
        prop_assert!(((after - before) * (0.5 / dt) - velocity).norm() < 1e-8);
        let second = (after - now - (now - before)) * (1.0 / (dt * dt));
        prop_assert!((second - acceleration).norm() < 1e-3, "{second:?} {acceleration:?}");
    }
}

fn narrow(segment: &Segment<f64>) -> Segment<f32> {
    let narrow = |v: V| Vector2::new(v.x as f32, v.y as f32);
    let [from, to] = [narrow(segment.start()), narrow(segment.end())];
    match *segment.curve() {
        Curve::Arc {
            start,
            tangent,
            curvature,
        } => {
            let centre = narrow(start + tangent.perpendicular() * (1.0 / curvature));
            let sense = if curvature > 0.0 {
                Sense::CounterClockwise
            } else {
                Sense::Clockwise
            };
            Segment::arc(from, to, centre, sense, 1e-5)
        }
        _ => Segment::line(from, to),
    }
    .unwrap()
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

/// Six full circles through one point: long stretches with a slow corner after each.
#[test]
fn slow_corners_do_not_slow_what_lies_between() {
    let point = V::new(MIDDLE[0], MIDDLE[1]);
    let circles: Vec<_> = (0..6)
        .map(|turn| point + V::unit(f64::from(turn)) * 0.016)
        .map(|centre| Segment::arc(point, point, centre, Sense::Clockwise, 1e-5).unwrap())
        .collect();
    let time = |corner_tolerance| -> f64 {
        let pieces = run(&circles, 0.25, &envelope(corner_tolerance));
        pieces.iter().map(Piece::duration).sum()
    };
    let (rounded, stopped) = (time(5e-5), time(0.0));
    assert!(rounded < stopped, "{rounded} s against {stopped} s");
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
    assert_eq!((velocity, acceleration), (V::zeros(), V::zeros()));
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

/// The corner to a new move asks for less jerk than the stop in hand is made of: let go as
/// gently as that, the arm would run backwards before it went on.
#[test]
fn a_move_that_comes_while_the_arm_stops_does_not_turn_it_back() {
    let envelope = envelope(1e-4);
    let points = [[0.1232, 0.3248], [0.1297, 0.3416], [0.1374, 0.36]].map(|[x, y]| V::new(x, y));
    let [before, after] = [0, 1].map(|i| Segment::line(points[i], points[i + 1]).unwrap());
    let push = |look_ahead: &mut LookAhead<f64, 16>, segment: &Segment<f64>| {
        let caps = envelope.admit(segment, 0.01).unwrap();
        look_ahead.push(segment, caps, 0, &envelope).unwrap();
    };
    let mut joined = 0;
    for taken in 1.. {
        let mut look_ahead = LookAhead::new();
        push(&mut look_ahead, &before);
        let mut pieces: Vec<_> = (0..taken).map_while(|_| look_ahead.next_piece()).collect();
        if pieces.len() < taken {
            break;
        }
        push(&mut look_ahead, &after);
        pieces.extend(core::iter::from_fn(|| look_ahead.next_piece()));
        let limits = Caps {
            speed: 0.01,
            ..envelope.tool_motion
        };
        assert_sound(&pieces, [points[0], points[2]], &limits, &DOUBLE);
        let forwards = (points[2] - points[0]) * (1.0 / (points[2] - points[0]).norm());
        let slowest = pieces
            .iter()
            .flat_map(|piece| (0..=12).map(|i| tool(piece, piece.duration() * f64::from(i) / 12.0)))
            .map(|(_, velocity, _)| velocity.dot(&forwards))
            .fold(f64::INFINITY, f64::min);
        assert!(slowest > -1e-9, "{slowest} m/s, {taken} pieces taken");
        joined += 1;
    }
    assert!(joined > 4, "{joined} pieces");
}
