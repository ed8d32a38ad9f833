//! Every refusal says what is wrong.

use fivebar_kinematics::dynamics::ModelError;
use fivebar_kinematics::five_bar::{
    DyadError, GeometryError, Joint, JointLimitError, PoseError, Side, Singularity, Unreachable,
    WorkspaceViolation,
};

/// Each text says something, and something else than the ones before.
#[track_caller]
fn differ(texts: &[String]) {
    for (number, text) in texts.iter().enumerate() {
        assert!(text.split(' ').count() > 2, "{text}");
        assert!(!texts[..number].contains(text), "{text}");
    }
}

#[test]
fn every_refused_pose_names_its_leg_or_its_links() {
    let unreachable = [
        Unreachable::Leg1TooFar,
        Unreachable::Leg1TooNear,
        Unreachable::Leg4TooFar,
        Unreachable::Leg4TooNear,
        Unreachable::ElbowsTooFar,
        Unreachable::ElbowsTooNear,
    ];
    let singular = [Singularity::Leg1, Singularity::Leg4, Singularity::Parallel];
    let mut texts: Vec<String> = Vec::new();
    texts.extend(unreachable.map(|why| why.to_string()));
    texts.extend(singular.map(|which| which.to_string()));
    texts.push(PoseError::NotFinite.to_string());
    differ(&texts);
    assert_eq!(PoseError::Unreachable(unreachable[2]).to_string(), texts[2]);
    assert_eq!(PoseError::Singular(singular[1]).to_string(), texts[7]);
    assert!(texts[0].contains("farther from A") && texts[7].starts_with("leg E–D–C"));
}

#[test]
fn every_refused_dyad_says_how_its_links_miss() {
    let texts = [
        DyadError::InLine([0.1, 0.2].into()),
        DyadError::TooFar,
        DyadError::TooNear,
        DyadError::Coincident,
        DyadError::NotFinite,
    ]
    .map(|error: DyadError<f64>| error.to_string());
    differ(&texts);
    assert_eq!(texts[0], "the two links are in line");
}

#[test]
fn every_refused_joint_is_named() {
    let texts = [
        JointLimitError::Range(Joint::Joint1),
        JointLimitError::Range(Joint::Joint4),
        JointLimitError::Outside(Joint::Joint1),
        JointLimitError::Outside(Joint::Joint4),
    ]
    .map(|error| error.to_string());
    differ(&texts);
    assert_eq!(texts[3], "joint 4 would leave its limits");
    let violations = [
        WorkspaceViolation::Pose(PoseError::NotFinite),
        WorkspaceViolation::Joint(Joint::Joint1),
        WorkspaceViolation::Margin(Singularity::Parallel),
    ]
    .map(|violation| violation.to_string());
    differ(&violations);
    assert_eq!(violations[1], texts[2]);
}

#[test]
fn every_refused_length_and_mass_is_named() {
    let texts = [0, 1, 2, 3, 4].map(|index| GeometryError::NotPositive(index).to_string());
    differ(&texts);
    assert!(texts[0].starts_with("length l1") && texts[4].starts_with("length base"));
    differ(&[
        GeometryError::CannotAssemble.to_string(),
        GeometryError::ToolOffset.to_string(),
        ModelError::Link(2).to_string(),
        ModelError::Payload.to_string(),
        ModelError::Gravity.to_string(),
        ModelError::RotorInertia.to_string(),
        ModelError::NoInertia(4).to_string(),
    ]);
}

#[test]
fn a_side_has_a_name_that_can_be_aligned() {
    assert_eq!(
        Side::BOTH.map(|side| format!("{side:>6}")),
        ["  left", " right"]
    );
}
