//! Helpers of the trajectory tests: an arm, a run of moves through the look-ahead, and the checks
//! that every motion must pass.

use fivebar_kinematics::five_bar::{Geometry, Side, Tool, WorkingMode, Workspace};
use fivebar_kinematics::trajectory::{
    Envelope, LookaheadPlanner, MotionLimits, PathSegment, Reference, TrajectorySegment,
};
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

pub(crate) type V = Vector2<f64>;

/// Middle of the region where the test arm moves freely [m].
pub(crate) const MIDDLE: [f64; 2] = [0.1375, 0.3];

/// The symmetric arm, elbows out.
pub(crate) fn envelope<S: Scalar>(corner_tolerance: f64) -> Envelope<S> {
    let c = S::from_f64;
    let geometry = Geometry::new([0.23, 0.23, 0.23, 0.23, 0.275].map(c)).unwrap();
    Envelope {
        workspace: Workspace {
            tool: Tool::new(geometry, Vector2::zeros()).unwrap(),
            mode: WorkingMode::new(Side::Right, Side::Left),
            limits: None,
            margin: c(0.05),
        },
        joint_speed: [c(100.0); 2],
        joint_acceleration: [c(10_000.0); 2],
        torque: None,
        tool_motion: MotionLimits {
            speed: c(0.3),
            acceleration: c(5.0),
            jerk: c(500.0),
        },
        corner_tolerance: c(corner_tolerance),
    }
}

/// Position, velocity and acceleration of the tool.
pub(crate) fn tool<S: Scalar>(trajectory_segment: &TrajectorySegment<S>, t: S) -> (V, V, V) {
    let wide = |v: Vector2<S>| V::new(v.x.to_f64(), v.y.to_f64());
    match trajectory_segment.evaluate(t) {
        Reference::Tool {
            position,
            velocity,
            acceleration,
        } => (wide(position), wide(velocity), wide(acceleration)),
        Reference::Joint { .. } => panic!("a path moves the tool"),
    }
}

/// Runs segments through the look-ahead with its queue as full as it allows.
pub(crate) fn run<S: Scalar>(
    segments: &[PathSegment<S>],
    feed: S,
    envelope: &Envelope<S>,
) -> Vec<TrajectorySegment<S>> {
    let mut lookahead = LookaheadPlanner::<S, 32>::new();
    let mut trajectory = Vec::new();
    for (tag, segment) in segments.iter().enumerate() {
        let limits = envelope.check(segment, feed).unwrap();
        while !lookahead.has_free_slot() {
            trajectory.push(lookahead.next_segment().unwrap());
        }
        lookahead
            .push(segment, limits, tag as u32, envelope)
            .unwrap();
    }
    while let Some(trajectory_segment) = lookahead.next_segment() {
        trajectory.push(trajectory_segment);
    }
    assert!(lookahead.is_empty());
    trajectory
}

/// The greatest difference of two neighbouring references, by rounding.
pub(crate) struct Rounding {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
    pub(crate) acceleration: f64,
}

/// Asserts that the motion is continuous, from rest at `start` to rest at `end`, and within the
/// limits everywhere; returns its duration.
pub(crate) fn assert_valid<S: Scalar>(
    trajectory: &[TrajectorySegment<S>],
    [start, end]: [V; 2],
    limits: &MotionLimits<f64>,
    rounding: &Rounding,
) -> f64 {
    const STEPS: u32 = 12;
    let mut last = (start, V::zeros(), V::zeros());
    let mut time = 0.0;
    for (index, trajectory_segment) in trajectory.iter().enumerate() {
        let first = tool(trajectory_segment, S::ZERO);
        let near = (first.0 - last.0).length() <= rounding.position
            && (first.1 - last.1).length() <= rounding.velocity
            && (first.2 - last.2).length() <= rounding.acceleration;
        assert!(near, "trajectory_segment {index}: {first:?} after {last:?}");
        let duration = trajectory_segment.duration().to_f64();
        assert!(duration > 0.0);
        let dt = duration / f64::from(STEPS);
        let mut before = first;
        for step in 1..=STEPS {
            let now = tool(trajectory_segment, S::from_f64(dt * f64::from(step)));
            assert!(now.1.length() <= limits.speed * (1.0 + 1e-5));
            assert!(now.2.length() <= limits.acceleration * (1.0 + 1e-5) + rounding.acceleration);
            // The mean of the jerk, and of the acceleration, over a step.
            let jerk = (now.2 - before.2).length() / dt;
            assert!(
                (now.2 - before.2).length()
                    <= limits.jerk * dt * (1.0 + 1e-5) + rounding.acceleration,
                "trajectory_segment {index}: jerk {jerk}"
            );
            let middle = (before.1 + now.1) * 0.5;
            let moved = now.0 - before.0 - middle * dt;
            assert!(moved.length() <= limits.jerk * dt * dt * dt + rounding.position);
            before = now;
        }
        last = tool(trajectory_segment, S::from_f64(duration));
        time += duration;
    }
    assert!(
        (last.0 - end).length() <= rounding.position,
        "ends at {last:?}, not {end:?}"
    );
    assert!(last.1.length() <= rounding.velocity && last.2.length() <= rounding.acceleration);
    time
}

/// Distance from a segment to a point, densely sampled and refined [m].
pub(crate) fn distance_to<S: Scalar>(segment: &PathSegment<S>, point: V) -> f64 {
    let length = segment.length().to_f64();
    let at = |s: f64| {
        let p = segment.at(S::from_f64(s)).position;
        (V::new(p.x.to_f64(), p.y.to_f64()) - point).length()
    };
    const SAMPLES: u32 = 64;
    let step = length / f64::from(SAMPLES);
    let nearest = (0..=SAMPLES)
        .map(|i| f64::from(i) * step)
        .min_by(|&a, &b| at(a).total_cmp(&at(b)))
        .unwrap();
    let (mut low, mut high) = ((nearest - step).max(0.0), (nearest + step).min(length));
    for _ in 0..60 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if at(a) < at(b) {
            high = b;
        } else {
            low = a;
        }
    }
    at((low + high) / 2.0)
}
