//! Workspace, its limits and its margin from singularities.

use fivebar_kinematics::five_bar::{
    Geometry, Joint, JointLimits, Pose, PoseError, Tool, Unreachable, WorkingMode, Workspace,
    WorkspaceViolation,
};
use fivebar_testkit::pose;
use nalgebra::Vector2;
use proptest::prelude::*;
use std::f64::consts::PI;

proptest! {
    #[test]
    fn clearances_vanish_with_their_sines(case in pose(1e-3)) {
        let clearances = case.geometry.clearances(&case.pose);
        let sines = [case.pose.sin21(), case.pose.sin34(), case.pose.sin32()];
        let [l1, l2, l3, l4, _] = case.geometry.lengths();
        let dyads = [(l1, l2), (l4, l3), (l2, l3)];
        for ((clearance, sine), (first, second)) in
            [clearances.leg1, clearances.leg4, clearances.parallel].into_iter().zip(sines).zip(dyads)
        {
            prop_assert_eq!(clearance.sine, sine.abs());
            prop_assert!(clearance.length > 0.0);
            // With the dyad's ends d apart, 4 l l' − … = ((l+l')² − d²)(d² − (l−l')²)
            // = (2 l l' sin)², so that a length left bounds the sine from below.
            let least = clearance.length.powi(2) / (2.0 * first * second);
            prop_assert!(clearance.sine >= least * (1.0 - 1e-9));
        }
    }
}

#[test]
fn c_has_no_speed_where_both_legs_are_straight() {
    // Two legs of 5 m + 5 m along 3 : 4 : 5 triangles, so that the sines are exactly zero.
    let geometry = Geometry::new([5.0, 5.0, 5.0, 5.0, 12.0]).unwrap();
    let (u1, u4) = (Vector2::new(0.6, 0.8), Vector2::new(-0.6, 0.8));
    let pose = Pose {
        u1,
        u2: u1,
        u3: u4,
        u4,
        b: u1 * 5.0,
        c: u1 * 10.0,
        d: geometry.e() + u4 * 5.0,
    };
    let jacobian = geometry.jacobian(&pose).unwrap();
    assert_eq!(jacobian.singular_values(), [0.0, 0.0]);
    assert_eq!(jacobian.inverse_condition(), 0.0);
}

#[test]
fn a_workspace_says_what_stands_in_the_way() {
    let geometry = Geometry::new([0.1, 0.16, 0.16, 0.1, 0.08]).unwrap();
    let tool = Tool::new(geometry, Vector2::new(0.02, 0.01)).unwrap();
    let workspace = Workspace {
        tool,
        mode: WorkingMode::ALL[2],
        limits: Some(JointLimits::new([0.5 * PI, 1.4 * PI], [-0.4 * PI, 0.5 * PI]).unwrap()),
        margin: 0.2,
    };
    let t = Vector2::new(0.06, 0.18);
    let pose = workspace.check(t).unwrap();
    assert!((tool.point(&pose) - t).norm() < 1e-15);

    let far = workspace.check(Vector2::new(0.5, 0.5));
    let too_far = PoseError::Unreachable(Unreachable::Leg1TooFar);
    assert_eq!(far, Err(WorkspaceViolation::Pose(too_far)));

    let narrow = Workspace {
        limits: Some(JointLimits::new([0.5 * PI, 1.4 * PI], [-0.4 * PI, -0.1]).unwrap()),
        ..workspace
    };
    assert_eq!(
        narrow.check(t),
        Err(WorkspaceViolation::Joint(Joint::Joint4))
    );

    let (nearest, sine) = tool.nearest_singularity(&pose);
    let cautious = Workspace {
        margin: sine + 1e-3,
        ..workspace
    };
    assert_eq!(cautious.check(t), Err(WorkspaceViolation::Margin(nearest)));
}
