//! Properties of a linkage's groups and joints.

use fivebar_design::linkage::dyad::SlideBranch;
use fivebar_design::linkage::{Group, Reaction};
use fivebar_kinematics::five_bar::Side;

/// A dyad's branch, with the word of its file; none for a group with one branch.
pub(crate) fn branch(group: &Group<f64>) -> Option<&'static str> {
    let of_slide = |branch| match branch {
        SlideBranch::Ahead => "ahead",
        SlideBranch::Behind => "behind",
    };
    Some(match group {
        Group::Rrr { dyad, .. } => match dyad.side {
            Side::Left => "left",
            Side::Right => "right",
        },
        Group::Rrp { dyad, .. } => of_slide(dyad.branch),
        Group::Rpr { dyad, .. } => of_slide(dyad.branch),
        _ => return None,
    })
}

/// The number of a group's sliding joints.
pub(crate) fn sliding_joints(group: &Group<f64>) -> usize {
    match group {
        Group::Crank { .. } | Group::Slider { .. } | Group::Rrr { .. } => 0,
        Group::Rrp { .. } | Group::Rpr { .. } => 1,
        Group::Prp { .. } | Group::Rpp { .. } => 2,
    }
}

/// The moment of a reaction about its joint's centre [N·m]: in a driven pin the driving
/// torque, in a free pin zero, in a slide the moment that keeps the slider from tilting.
pub(crate) fn moment(reaction: &Reaction<f64>) -> f64 {
    reaction.wrench.moment_about(reaction.joint.position())
}
