//! Runs of short lines, and corners of lines with arcs: how far the motion leaves them, and how long
//! it takes.

use crate::bound::least_time;
use crate::common::{MIDDLE, Rounding, V, assert_valid, envelope, run, tool};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::trajectory::{
    Envelope, MotionLimits, PathSegment, Sense, TrajectorySegment,
};
use proptest::prelude::*;

/// Lines of half a millimetre or so, as of a traced drawing: directions that wander.
fn polylines() -> impl Strategy<Value = Vec<PathSegment<f64>>> {
    let step = (-1.2..1.2_f64, -3.7..-2.8_f64);
    prop::collection::vec(step, 4..60).prop_map(|steps| {
        let mut from = V::new(MIDDLE[0], MIDDLE[1]);
        let mut direction = 0.0;
        steps
            .into_iter()
            .map(|(turn, exponent)| {
                direction += turn;
                let to = from + V::unit(direction) * 10_f64.powf(exponent);
                let line = PathSegment::line(from, to).unwrap();
                from = to;
                line
            })
            .collect()
    })
}

fn limited(corner_tolerance: f64, jerk: f64) -> Envelope<f64> {
    let envelope = envelope(corner_tolerance);
    Envelope {
        tool_motion: MotionLimits {
            jerk,
            ..envelope.tool_motion
        },
        ..envelope
    }
}

fn time(segments: &[PathSegment<f64>], feed: f64, envelope: &Envelope<f64>) -> f64 {
    let trajectory = run(segments, feed, envelope);
    trajectory.iter().map(TrajectorySegment::duration).sum()
}

/// From a line to a point [m].
fn distance(line: &PathSegment<f64>, point: V) -> f64 {
    let along = (point - line.start()).dot(&line.at(0.0).tangent);
    (point - line.at(along.clamp(0.0, line.length())).position).norm()
}

/// A sharp corner, whose blend is short, and a flat one, whose blend would be long.
#[test]
fn two_corners_of_a_line_take_half_of_it_each_at_most() {
    let corners = [[0.113, 0.293], [0.12, 0.3], [0.122, 0.3], [0.132, 0.301]];
    let corners = corners.map(|[x, y]| V::new(x, y));
    let line = |ends: &[V]| PathSegment::line(ends[0], ends[1]).unwrap();
    let segments: Vec<_> = corners.windows(2).map(line).collect();
    let middle = (corners[1] + corners[2]) * 0.5;
    let trajectory = run(&segments, 0.06, &limited(5e-5, 1000.0));
    let mut nearest = f64::MAX;
    for trajectory_segment in &trajectory {
        for step in 0..=100 {
            let t = trajectory_segment.duration() * f64::from(step) / 100.0;
            let (position, velocity, _) = tool(trajectory_segment, t);
            // How far the path passes from the middle, seen from a place near it.
            if (position.x - middle.x).abs() < 1e-4 && velocity.length() > 0.0 {
                nearest = nearest.min((position.y - middle.y).abs());
            }
        }
    }
    assert!(nearest < 1e-9, "{nearest} m from the line's middle");
}

proptest! {
    /// The distance to the whole polyline, whatever segment a place belongs to.
    #[test]
    fn the_motion_stays_within_the_tolerance_of_the_lines(
        segments in polylines(), tolerance in prop::sample::select(vec![1e-5, 5e-5, 2e-4]),
    ) {
        let trajectory = run(&segments, 0.06, &limited(tolerance, 1000.0));
        let mut greatest = 0.0_f64;
        for trajectory_segment in &trajectory {
            for step in 0..=3 {
                let t = trajectory_segment.duration() * f64::from(step) / 3.0;
                let position = tool(trajectory_segment, t).0;
                let near = segments.iter().map(|line| distance(line, position));
                greatest = greatest.max(near.fold(f64::MAX, f64::min));
            }
        }
        prop_assert!(greatest <= tolerance + 1e-9, "{greatest} m off the lines");
    }

    /// With a high jerk the speed rises within corners, with a low one it does not.
    #[test]
    fn short_lines_keep_all_limits_at_any_jerk(segments in polylines(), jerk in 2.0..6.0_f64) {
        // Remainders of a nanosecond are dropped.
        const ROUNDING: Rounding = Rounding {
            position: 1e-9,
            velocity: 1e-8,
            acceleration: 2e-3,
        };
        let envelope = limited(5e-5, 10_f64.powf(jerk));
        let trajectory = run(&segments, 0.2, &envelope);
        let ends = [segments[0].start(), segments[segments.len() - 1].end()];
        let limits = MotionLimits { speed: 0.2, ..envelope.tool_motion };
        assert_valid(&trajectory, ends, &limits, &ROUNDING);
    }

    /// The choice of shares and of stops rests on estimates, so a few paths of very short lines take
    /// a few percent longer.
    #[test]
    fn a_looser_tolerance_is_hardly_ever_slower(segments in polylines(), jerk in 3.0..6.0_f64) {
        let jerk = 10_f64.powf(jerk);
        let mut last = time(&segments, 0.06, &limited(0.0, jerk));
        for tolerance in [1e-5, 2e-5, 5e-5, 1e-4, 2e-4] {
            let now = time(&segments, 0.06, &limited(tolerance, jerk));
            prop_assert!(now <= last * 1.06, "{now} s at {tolerance} m, {last} s before");
            last = now;
        }
    }
}

/// Twelve teeth: a line out, an arc along the tip, a line in, an arc along the root.
fn gear() -> Vec<PathSegment<f64>> {
    let centre = V::new(MIDDLE[0], MIDDLE[1]);
    let at =
        |radius: f64, tooth: f64| centre + V::unit(tooth * core::f64::consts::TAU / 12.0) * radius;
    let mut segments = Vec::new();
    for tooth in 0..12 {
        let tooth = f64::from(tooth);
        let points = [
            at(0.025, tooth),
            at(0.030, tooth + 0.15),
            at(0.030, tooth + 0.5),
            at(0.025, tooth + 0.65),
            at(0.025, tooth + 1.0),
        ];
        let arc =
            |from, to| PathSegment::arc(from, to, centre, Sense::CounterClockwise, 1e-9).unwrap();
        segments.push(PathSegment::line(points[0], points[1]).unwrap());
        segments.push(arc(points[1], points[2]));
        segments.push(PathSegment::line(points[2], points[3]).unwrap());
        segments.push(arc(points[3], points[4]));
    }
    segments
}

#[test]
fn a_gear_takes_no_longer_with_a_looser_tolerance() {
    for jerk in [100.0, 200.0, 1000.0, 1e6] {
        let mut last = f64::MAX;
        for tolerance in [1e-5, 2e-5, 5e-5, 7e-5, 1e-4, 1.5e-4, 2e-4, 3e-4] {
            let now = time(&gear(), 0.15, &limited(tolerance, jerk));
            assert!(
                now <= last * 1.001,
                "{now} s at {tolerance} m, {last} s before, {jerk} m/s³"
            );
            last = now;
        }
        assert!(last < time(&gear(), 0.15, &limited(0.0, jerk)), "{last} s");
    }
}

/// A traced drawing of 600 lines of 0.4 to 1.6 mm, with turns of up to 1 rad.
fn drawing() -> Vec<PathSegment<f64>> {
    let (mut from, mut direction) = (V::new(MIDDLE[0], MIDDLE[1] - 0.02), 0.0);
    (0..600)
        .map(|step| {
            let wave = |rate: f64| (f64::from(step) * rate).sin();
            direction += 0.05 + 0.6 * wave(1.7) * wave(0.31) + 0.35 * wave(4.1);
            let length = 4e-4 * 4_f64.powf(0.5 + 0.5 * wave(2.3));
            let to = from + V::unit(direction) * length;
            let line = PathSegment::line(from, to).unwrap();
            from = to;
            line
        })
        .collect()
}

/// Against the least time for the same rounded path under the limits of speed and acceleration.
#[test]
fn a_traced_drawing_takes_little_longer_than_its_bound() {
    for (jerk, ratio) in [(1e6, 1.06), (1000.0, 1.2)] {
        let envelope = limited(5e-5, jerk);
        let trajectory = run(&drawing(), 0.06, &envelope);
        let taken: f64 = trajectory.iter().map(TrajectorySegment::duration).sum();
        let bound = least_time(&trajectory, 0.06, envelope.tool_motion.acceleration);
        assert!(
            taken < ratio * bound,
            "{taken} s, bound {bound} s, {jerk} m/s³"
        );
        assert!(taken > bound, "{taken} s, bound {bound} s");
    }
}
