//! What a linkage's groups and joints are like.

use fivebar_design::linkage::dyad::SlideBranch;
use fivebar_design::linkage::{Group, Reaction};
use fivebar_kinematics::five_bar::Side;

/// A dyad's branch, in the words of its file.
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

/// How many sliding joints a group's solution has.
pub(crate) fn slides(group: &Group<f64>) -> usize {
    match group {
        Group::Crank { .. } | Group::Slider { .. } | Group::Rrr { .. } => 0,
        Group::Rrp { .. } | Group::Rpr { .. } => 1,
        Group::Prp { .. } | Group::Rpp { .. } => 2,
    }
}

/// The moment of a reaction about its joint's own centre [N·m]: of a pin its driving
/// torque or nothing, of a slide what keeps the slider from tilting.
pub(crate) fn moment(reaction: &Reaction<f64>) -> f64 {
    reaction.wrench.moment_about(reaction.joint.place())
}
