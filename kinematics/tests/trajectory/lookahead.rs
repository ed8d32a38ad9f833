//! The motion that the look-ahead plans: continuous, within its limits and the corner tolerance,
//! with the right end.

use crate::common::{MIDDLE, Rounding, V, assert_valid, distance_to, envelope, run, tool};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::trajectory::{
    Curve, LookaheadPlanner, MotionLimits, PathSegment, Reference, Sense, TrajectorySegment,
};
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
fn paths(finest: f64) -> impl Strategy<Value = Vec<PathSegment<f64>>> {
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
            let arc = PathSegment::arc(from, to, centre, Sense::Clockwise, 1e-9);
            let fits = (centre - middle).norm() + radius < 0.07;
            segments.push(if fits && !line {
                arc.unwrap()
            } else {
                PathSegment::line(from, to).unwrap()
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
        let trajectory = run(&segments, feed, &envelope);
        let limits = MotionLimits { speed: feed, ..envelope.tool_motion };
        let ends = [segments[0].start(), segments.last().unwrap().end()];
        assert_valid(&trajectory, ends, &limits, &DOUBLE);

        // Every position is on the path, and the motion covers the whole path.
        let mut reached = vec![false; segments.len()];
        for trajectory_segment in &trajectory {
            let tag = trajectory_segment.tag() as usize;
            reached[tag] = true;
            for step in 0..=6 {
                let position = tool(trajectory_segment, trajectory_segment.duration() * f64::from(step) / 6.0).0;
                let mut distance = distance_to(&segments[tag], position);
                // A blend has the tag of the segment after it.
                if distance > tolerance && tag > 0 {
                    distance = distance.min(distance_to(&segments[tag - 1], position));
                }
                prop_assert!(distance <= tolerance + 1e-9, "{distance} m off segment {tag}");
            }
        }
        prop_assert!(reached.iter().all(|&reached| reached));
    }

    /// Moves may be added at any time, also when the queue is empty, and each trajectory segment may be taken in haste.
    #[test]
    fn moves_that_come_late_are_joined_to_the_motion_at_hand(
        segments in paths(-5.0),
        // Trajectory segments taken before each push.
        taken in prop::collection::vec(0..9_usize, 30),
        in_haste in prop::collection::vec(prop::bool::ANY, 7),
        feed in 0.01..0.3_f64,
    ) {
        let envelope = envelope(1e-4);
        let mut lookahead = LookaheadPlanner::<f64, 16>::new();
        let mut trajectory = Vec::new();
        let mut in_haste = in_haste.into_iter().cycle();
        let mut next = |lookahead: &mut LookaheadPlanner<f64, 16>| match in_haste.next() {
            Some(true) => lookahead.next_segment_in_haste(),
            _ => lookahead.next_segment(),
        };
        for ((tag, segment), taken) in segments.iter().enumerate().zip(taken) {
            let before = trajectory.len() + taken;
            while trajectory.len() < before || lookahead.free_slots() == 0 {
                let Some(trajectory_segment) = next(&mut lookahead) else { break };
                trajectory.push(trajectory_segment);
            }
            let limits = envelope.check(segment, feed).unwrap();
            lookahead.push(segment, limits, tag as u32, &envelope).unwrap();
        }
        while let Some(trajectory_segment) = next(&mut lookahead) {
            trajectory.push(trajectory_segment);
        }
        let limits = MotionLimits { speed: feed, ..envelope.tool_motion };
        let ends = [segments[0].start(), segments.last().unwrap().end()];
        assert_valid(&trajectory, ends, &limits, &DOUBLE);
    }

    /// In single precision the same path is followed, to a micrometre.
    #[test]
    fn single_precision_follows_the_same_path(
        segments in paths(-4.0),
        feed in 0.01..0.3_f64,
    ) {
        const TOLERANCE: f64 = 5e-5;
        let single: Vec<PathSegment<f32>> = segments.iter().map(narrow).collect();
        let envelope = envelope::<f32>(TOLERANCE);
        let trajectory = run(&single, feed as f32, &envelope);
        let limits = MotionLimits { speed: feed, acceleration: 5.0, jerk: 500.0 };
        let ends = [segments[0].start(), segments.last().unwrap().end()];
        let single_time = assert_valid(&trajectory, ends, &limits, &SINGLE);
        for trajectory_segment in &trajectory {
            let tag = trajectory_segment.tag() as usize;
            for step in 0..=4_u8 {
                let position = tool(trajectory_segment, trajectory_segment.duration() * f32::from(step) / 4.0).0;
                let mut distance = distance_to(&segments[tag], position);
                if tag > 0 {
                    distance = distance.min(distance_to(&segments[tag - 1], position));
                }
                prop_assert!(distance <= TOLERANCE + 1e-6, "{distance} m off segment {tag}");
            }
        }
        let double = run(&segments, feed, &crate::common::envelope(TOLERANCE));
        let double_time: f64 = double.iter().map(TrajectorySegment::duration).sum();
        prop_assert!((single_time / double_time - 1.0).abs() < 0.05, "{single_time} s, {double_time} s");
    }

    /// v = σ p′ and a = σ² p″ + σ̇ p′ are the derivatives of p(τ(t)) with τ̇ = σ.
    #[test]
    fn a_slowed_clock_gives_the_derivatives_of_the_slowed_motion(
        segments in paths(-5.0), at in 0.1..0.9_f64, rate in 0.0..1.0_f64, slope in -30.0..30.0_f64,
    ) {
        let trajectory = run(&segments, 0.2, &envelope(1e-4));
        let trajectory_segment = trajectory[((trajectory.len() - 1) as f64 * at) as usize];
        let tau = trajectory_segment.duration() * at;
        let dt = 1e-6;
        let place = |t: f64| tool(&trajectory_segment, tau + (rate + 0.5 * slope * t) * t).0;
        let (before, now, after) = (place(-dt), place(0.0), place(dt));
        let Reference::Tool { position, velocity, acceleration } =
            trajectory_segment.reference(trajectory_segment.path_state(tau).time_scaled(rate, slope)) else { panic!() };
        prop_assert_eq!(position, now);
        prop_assert!(((after - before) * (0.5 / dt) - velocity).norm() < 1e-8);
        let second = (after - now - (now - before)) * (1.0 / (dt * dt));
        prop_assert!((second - acceleration).norm() < 1e-3, "{second:?} {acceleration:?}");
    }
}

fn narrow(segment: &PathSegment<f64>) -> PathSegment<f32> {
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
            PathSegment::arc(from, to, centre, sense, 1e-5)
        }
        _ => PathSegment::line(from, to),
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
        .map(|ends| PathSegment::line(ends[0], ends[1]).unwrap())
        .collect();
    let trajectory = run(&segments, 0.058, &envelope);
    let limits = MotionLimits {
        speed: 0.058,
        ..envelope.tool_motion
    };
    let time = assert_valid(&trajectory, [points[0], points[999]], &limits, &DOUBLE);
    let ideal = 0.04 * 0.005 * 999.0 / 0.058;
    assert!(time < ideal * 1.02, "{time} s instead of {ideal} s");
}

/// The blend of two collinear lines takes up half of each.
#[test]
fn a_line_in_pieces_takes_as_long_as_the_whole_line() {
    let envelope = envelope(5e-5);
    let [from, to] = [[0.08, 0.30], [0.12, 0.30]].map(|[x, y]| V::new(x, y));
    let time = |pieces: u32| -> f64 {
        let at = |i: u32| from + (to - from) * (f64::from(i) / f64::from(pieces));
        let segments: Vec<_> = (0..pieces)
            .map(|i| PathSegment::line(at(i), at(i + 1)).unwrap())
            .collect();
        let trajectory = run(&segments, 0.1, &envelope);
        trajectory.iter().map(TrajectorySegment::duration).sum()
    };
    let whole = time(1);
    for pieces in [2, 3, 4, 7, 12] {
        let cut = time(pieces);
        assert!(
            cut < whole * 1.03,
            "{cut} s in {pieces} pieces, {whole} s whole"
        );
    }
}

/// Six full circles through one point: long segments with a slow corner after each.
#[test]
fn slow_corners_do_not_slow_what_lies_between() {
    let point = V::new(MIDDLE[0], MIDDLE[1]);
    let circles: Vec<_> = (0..6)
        .map(|turn| point + V::unit(f64::from(turn)) * 0.016)
        .map(|centre| PathSegment::arc(point, point, centre, Sense::Clockwise, 1e-5).unwrap())
        .collect();
    let time = |corner_tolerance| -> f64 {
        let trajectory = run(&circles, 0.25, &envelope(corner_tolerance));
        trajectory.iter().map(TrajectorySegment::duration).sum()
    };
    let stopped = time(0.0);
    let mut last = stopped;
    for tolerance in [5e-5, 1e-4, 2e-4, 4e-4] {
        let rounded = time(tolerance);
        assert!(rounded <= last, "{rounded} s against {last} s");
        last = rounded;
    }
    assert!(last < 0.97 * stopped, "{last} s against {stopped} s");
}

#[test]
fn corners_without_tolerance_are_stopped_at() {
    let envelope = envelope(0.0);
    let [a, b, c] = [[0.10, 0.30], [0.15, 0.30], [0.15, 0.33]].map(|[x, y]| V::new(x, y));
    let segments = [
        PathSegment::line(a, b).unwrap(),
        PathSegment::line(b, c).unwrap(),
    ];
    let trajectory = run(&segments, 0.1, &envelope);
    let stop = trajectory
        .iter()
        .find(|trajectory_segment| trajectory_segment.tag() == 1)
        .unwrap();
    let (position, velocity, acceleration) = tool(stop, 0.0);
    assert!((position - b).norm() < 1e-15);
    assert_eq!((velocity, acceleration), (V::zeros(), V::zeros()));
}

#[test]
fn a_queue_that_runs_dry_ends_at_rest_and_goes_on() {
    let envelope = envelope(1e-4);
    let mut lookahead = LookaheadPlanner::<f64, 16>::new();
    let points = [[0.10, 0.30], [0.15, 0.30], [0.15, 0.33]].map(|[x, y]| V::new(x, y));
    for (tag, ends) in points.windows(2).enumerate() {
        let line = PathSegment::line(ends[0], ends[1]).unwrap();
        let limits = envelope.check(&line, 0.1).unwrap();
        lookahead
            .push(&line, limits, tag as u32, &envelope)
            .unwrap();
        let mut last = None;
        while let Some(trajectory_segment) = lookahead.next_segment() {
            last = Some(tool(&trajectory_segment, trajectory_segment.duration()));
        }
        let (position, velocity, acceleration) = last.unwrap();
        assert!((position - ends[1]).norm() < 1e-12);
        assert!(velocity.norm() < 1e-9 && acceleration.norm() < 1e-6);
    }
}

/// The corner to a new move allows less jerk than the stop in progress has. If the deceleration
/// were reduced with that jerk, the arm would move backwards before it continued.
#[test]
fn a_move_that_comes_while_the_arm_stops_does_not_turn_it_back() {
    let envelope = envelope(1e-4);
    let points = [[0.1232, 0.3248], [0.1297, 0.3416], [0.1374, 0.36]].map(|[x, y]| V::new(x, y));
    let [before, after] = [0, 1].map(|i| PathSegment::line(points[i], points[i + 1]).unwrap());
    let push = |lookahead: &mut LookaheadPlanner<f64, 16>, segment: &PathSegment<f64>| {
        let limits = envelope.check(segment, 0.01).unwrap();
        lookahead.push(segment, limits, 0, &envelope).unwrap();
    };
    let mut joined = 0;
    for taken in 1.. {
        let mut lookahead = LookaheadPlanner::new();
        push(&mut lookahead, &before);
        let mut trajectory: Vec<_> = (0..taken).map_while(|_| lookahead.next_segment()).collect();
        if trajectory.len() < taken {
            break;
        }
        push(&mut lookahead, &after);
        trajectory.extend(core::iter::from_fn(|| lookahead.next_segment()));
        let limits = MotionLimits {
            speed: 0.01,
            ..envelope.tool_motion
        };
        assert_valid(&trajectory, [points[0], points[2]], &limits, &DOUBLE);
        let forwards = (points[2] - points[0]) * (1.0 / (points[2] - points[0]).norm());
        let slowest = trajectory
            .iter()
            .flat_map(|trajectory_segment| {
                (0..=12).map(|i| {
                    tool(
                        trajectory_segment,
                        trajectory_segment.duration() * f64::from(i) / 12.0,
                    )
                })
            })
            .map(|(_, velocity, _)| velocity.dot(&forwards))
            .fold(f64::INFINITY, f64::min);
        assert!(slowest > -1e-9, "{slowest} m/s, {taken} trajectory taken");
        joined += 1;
    }
    assert!(joined > 4, "{joined} trajectory");
}
