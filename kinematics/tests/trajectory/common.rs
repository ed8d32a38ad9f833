//! What the trajectory tests share: an arm, a way to run moves through the look-ahead, and
//! the checks that every motion must stand.

use fivebar_kinematics::five_bar::{Geometry, Side, Tool, WorkingMode, Workspace};
use fivebar_kinematics::trajectory::{Caps, Envelope, LookAhead, Piece, Reference, Segment};
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
        tool_motion: Caps {
            speed: c(0.3),
            acceleration: c(5.0),
            jerk: c(500.0),
        },
        corner_tolerance: c(corner_tolerance),
    }
}

/// Position, velocity and acceleration of the tool.
pub(crate) fn tool<S: Scalar>(piece: &Piece<S>, t: S) -> (V, V, V) {
    let wide = |v: Vector2<S>| V::new(v.x.to_f64(), v.y.to_f64());
    match piece.evaluate(t) {
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
    segments: &[Segment<S>],
    feed: S,
    envelope: &Envelope<S>,
) -> Vec<Piece<S>> {
    let mut look_ahead = LookAhead::<S, 32>::new();
    let mut pieces = Vec::new();
    for (tag, segment) in segments.iter().enumerate() {
        let caps = envelope.admit(segment, feed).unwrap();
        while !look_ahead.has_room() {
            pieces.push(look_ahead.next_piece().unwrap());
        }
        look_ahead
            .push(segment, caps, tag as u32, envelope)
            .unwrap();
    }
    while let Some(piece) = look_ahead.next_piece() {
        pieces.push(piece);
    }
    assert!(look_ahead.is_empty());
    pieces
}

/// How far two neighbouring references may be apart: rounding.
pub(crate) struct Rounding {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
    pub(crate) acceleration: f64,
}

/// Continuous from rest at `start` to rest at `end`, within the limits everywhere; gives
/// the time it takes.
pub(crate) fn assert_sound<S: Scalar>(
    pieces: &[Piece<S>],
    [start, end]: [V; 2],
    limits: &Caps<f64>,
    rounding: &Rounding,
) -> f64 {
    const STEPS: u32 = 12;
    let mut last = (start, V::zeros(), V::zeros());
    let mut time = 0.0;
    for (index, piece) in pieces.iter().enumerate() {
        let first = tool(piece, S::ZERO);
        let near = (first.0 - last.0).length() <= rounding.position
            && (first.1 - last.1).length() <= rounding.velocity
            && (first.2 - last.2).length() <= rounding.acceleration;
        assert!(near, "piece {index}: {first:?} after {last:?}");
        let duration = piece.duration().to_f64();
        assert!(duration > 0.0);
        let dt = duration / f64::from(STEPS);
        let mut before = first;
        for step in 1..=STEPS {
            let now = tool(piece, S::from_f64(dt * f64::from(step)));
            assert!(now.1.length() <= limits.speed * (1.0 + 1e-5));
            assert!(now.2.length() <= limits.acceleration * (1.0 + 1e-5) + rounding.acceleration);
            // The mean of the jerk, and of the acceleration, over a step.
            let jerk = (now.2 - before.2).length() / dt;
            assert!(
                (now.2 - before.2).length()
                    <= limits.jerk * dt * (1.0 + 1e-5) + rounding.acceleration,
                "piece {index}: jerk {jerk}"
            );
            let middle = (before.1 + now.1) * 0.5;
            let moved = now.0 - before.0 - middle * dt;
            assert!(moved.length() <= limits.jerk * dt * dt * dt + rounding.position);
            before = now;
        }
        last = tool(piece, S::from_f64(duration));
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
pub(crate) fn distance_to<S: Scalar>(segment: &Segment<S>, point: V) -> f64 {
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
