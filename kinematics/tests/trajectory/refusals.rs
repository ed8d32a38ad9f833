//! The content of errors; a segment is accepted or refused as a whole.

use crate::common::{V, distance_to, envelope, run, tool};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Joint, JointLimits, PoseError, Side, WorkspaceViolation};
use fivebar_kinematics::trajectory::{ConstraintViolation, Envelope, PathSegment, Sense};
use fivebar_testkit::Tally;
use proptest::prelude::*;

#[test]
fn refusals_name_the_violation_and_the_place() {
    let mut envelope = envelope::<f64>(0.0);
    let from = V::new(0.1375, 0.3);
    let refusal = |envelope: &Envelope<f64>, to: V| {
        let line = PathSegment::line(from, to).unwrap();
        envelope.check(&line, 0.1).unwrap_err()
    };
    // Straight up: leg 1 becomes straight. The path is refused where |AC| reaches the margin's
    // circle, with the reserve of 1 % of the margin.
    let up = refusal(&envelope, V::new(0.1375, 0.6));
    let margin: f64 = 0.05 * 1.01;
    let ring = 0.23 * (2.0 + 2.0 * (1.0 - margin * margin).sqrt()).sqrt();
    let height = (ring * ring - 0.1375 * 0.1375).sqrt();
    assert!((up.point.y - height).abs() < 2e-5, "{up:?}");
    assert!(matches!(
        up.violation,
        ConstraintViolation::Workspace(WorkspaceViolation::Margin(_))
    ));
    // Straight down: elbows out, C comes into line with B and D.
    let down = refusal(&envelope, V::new(0.1375, 0.05));
    assert!(
        (down.point.y - 0.21057956).abs() < 0.02 && down.point.y > 0.21057956,
        "{down:?}"
    );
    // The path violates a joint limit in its middle; both ends are within the limits.
    let dip = PathSegment::arc(
        from,
        from + V::new(0.0, 1e-3),
        from + V::new(-0.03, 5e-4),
        Sense::Clockwise,
        1e-6,
    )
    .unwrap();
    assert!(envelope.check(&dip, 0.1).is_ok());
    let theta1 = |point| {
        let pose = envelope
            .workspace
            .tool
            .inverse(point, envelope.workspace.mode);
        pose.unwrap().u1.polar_angle()
    };
    let greatest = theta1(from).max(theta1(dip.end())) + 0.05;
    envelope.workspace.limits = Some(JointLimits::new([0.0, greatest], [-1.0, 3.0]).unwrap());
    let limited = envelope.check(&dip, 0.1).unwrap_err();
    assert_eq!(
        limited.violation,
        ConstraintViolation::Workspace(WorkspaceViolation::Joint(Joint::Joint1))
    );
    assert!(limited.fraction > 0.01 && limited.fraction < 0.5);
}

#[test]
fn what_is_not_a_number_is_refused() {
    let envelope = envelope::<f64>(0.0);
    let line = PathSegment::line(V::new(0.1, 0.3), V::new(0.15, 0.3)).unwrap();
    for feed in [f64::NAN, 0.0, -0.1] {
        assert_eq!(
            envelope.check(&line, feed).unwrap_err().violation,
            ConstraintViolation::Limits
        );
    }
    let moved = envelope.check_joint_move([f64::NAN, 1.0], [1.0, 1.0], Side::Left, 0.5);
    assert_eq!(
        moved.unwrap_err().violation,
        ConstraintViolation::Workspace(WorkspaceViolation::Pose(PoseError::NotFinite))
    );
    assert!(PathSegment::line(V::new(0.1, f64::NAN), V::new(0.1, 0.3)).is_err());
}

/// Some other controllers drop an unreachable part of a path, or check its ends only. Here a path
/// is either followed completely or refused.
#[test]
fn no_segment_is_dropped_or_cut() {
    let accepted = Tally::default();
    let end = || prop::array::uniform2(-0.2..0.45_f64);
    let bulge = prop::option::of(-2.0..2.0_f64);
    let config = ProptestConfig::with_cases(3000);
    proptest!(config, |(from in end(), to in end(), bulge in bulge)| {
        let envelope = envelope::<f64>(1e-4);
        let (from, to) = (V::new(from[0], from[1]), V::new(to[0], to[1]));
        let chord = to - from;
        let segment = match bulge {
            None => PathSegment::line(from, to),
            Some(bulge) => {
                let centre = from + chord * 0.5 + chord.perpendicular() * bulge;
                PathSegment::arc(from, to, centre, Sense::Clockwise, 1e-9)
            }
        }
        .unwrap();
        if !accepted.count(envelope.check(&segment, 0.2).is_ok()) {
            return Ok(());
        }
        let mut covered = 0.0;
        let mut last = from;
        for trajectory_segment in run(&[segment], 0.2, &envelope) {
            for step in 0..=16 {
                let here = tool(&trajectory_segment, trajectory_segment.duration() * f64::from(step) / 16.0).0;
                prop_assert!(distance_to(&segment, here) < 1e-9);
                prop_assert!(envelope.workspace.check(here).is_ok());
                covered += (here - last).norm();
                last = here;
            }
        }
        prop_assert!((last - to).norm() < 1e-9);
        // Chords of an arc are a little shorter than the arc.
        prop_assert!((covered / segment.length() - 1.0).abs() < 0.02);
    });
    accepted.assert_accepted(0.15);
    accepted.assert_refused(0.6);
}
