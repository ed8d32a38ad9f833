//! Runs of short lines: how far the motion leaves them, and how long it takes.

use crate::common::{MIDDLE, V, envelope, run, tool};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::trajectory::{Envelope, MotionLimits, PathSegment, TrajectorySegment};
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

fn time(segments: &[PathSegment<f64>], envelope: &Envelope<f64>) -> f64 {
    let trajectory = run(segments, 0.06, envelope);
    trajectory.iter().map(TrajectorySegment::duration).sum()
}

/// From a line to a point [m].
fn distance(line: &PathSegment<f64>, point: V) -> f64 {
    let along = (point - line.start()).dot(&line.at(0.0).tangent);
    (point - line.at(along.clamp(0.0, line.length())).position).norm()
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

    #[test]
    fn a_looser_tolerance_is_not_slower(segments in polylines(), jerk in 3.0..6.0_f64) {
        let jerk = 10_f64.powf(jerk);
        let mut last = time(&segments, &limited(0.0, jerk));
        for tolerance in [1e-5, 2e-5, 5e-5, 1e-4, 2e-4] {
            let now = time(&segments, &limited(tolerance, jerk));
            prop_assert!(now <= last * 1.06, "{now} s at {tolerance} m, {last} s before");
            last = now;
        }
    }
}
