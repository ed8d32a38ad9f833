//! Joint reactions and driving forces, dyad by dyad, in the opposite order of the positions.
//!
//! Each link is loaded by its weight, its inertia forces (d'Alembert) and the forces at its
//! points. A dyad is solved for its three reactions. The opposites of the two outer ones
//! load the links that carry it, which are solved later. The frame is last.

use super::group::{Group, LinkId};
use super::joint::Joint;
use super::model::Linkage;
use super::solve::{LinkageMotion, SolveError};
use super::statics::reactions;
use super::wrench::Wrench;
use fivebar_kinematics::Scalar;
use nalgebra::Vector2;

/// The force in a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction<S> {
    /// The element to which the joint belongs, an index in [`Linkage::elements`].
    pub element: usize,
    /// The link that exerts it.
    pub from: LinkId,
    /// The link on which it acts.
    pub on: LinkId,
    /// The joint. A driven joint also transmits its driving torque or force.
    pub joint: Joint<S>,
    /// The force [N], and its moment about the plane's origin [N·m].
    pub wrench: Wrench<S>,
}

/// The forces in a linkage, at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Forces<S> {
    /// The torque [N·m] of each crank or force [N] of each slider, in order.
    pub driving: Vec<S>,
    /// The joints' reactions, in the order of the elements; of a dyad: carrier on first
    /// link, first link on second, carrier on second.
    pub reactions: Vec<Reaction<S>>,
    /// The wrench of the linkage on its frame: shaking force and moment, with the weight.
    pub frame: Wrench<S>,
}

impl<S: Scalar> Linkage<S> {
    /// The forces that the motion needs, from gravity, the inertia of links and point
    /// masses, and the external forces on points. The joints are frictionless.
    ///
    /// # Errors
    /// `Singular` where the loads do not determine a dyad's reactions. A motion from
    /// [`Linkage::solve`] never gives this error.
    pub fn forces(&self, motion: &LinkageMotion<S>) -> Result<Forces<S>, SolveError> {
        let mut loads = self.loads(motion);
        let mut driving = Vec::new();
        let mut backwards = Vec::new();
        for (element, definition) in self.elements.iter().enumerate().rev() {
            let first = definition.first_link;
            let [carrier1, carrier2] = self.carriers(&definition.group);
            let reaction = |from, on, joint, wrench| Reaction {
                element,
                from,
                on,
                joint,
                wrench,
            };
            let [gap1, gap12, gap2] = definition.clearance_offsets();
            // The opposite of a reaction acts on the other link at that link's own position.
            let mut pass = |reaction: Reaction<S>, gap: Vector2<S>, loads: &mut [Wrench<S>]| {
                let LinkId(carrier) = reaction.from;
                loads[carrier] = loads[carrier] + -reaction.wrench.moved(-gap);
                backwards.push(reaction);
            };
            if let Some(dyad) = &motion.dyads[element] {
                let second = LinkId(first.0 + 1);
                let [joint1, joint12, joint2] = dyad.joints;
                // Link 1 with all its loads is shifted so that its inner pin coincides with
                // that of link 2.
                let joints = [joint1.moved(gap12), joint12, joint2];
                let on_links = [loads[first.0].moved(gap12), loads[second.0]];
                let [r1, r12, r2] = reactions(&joints, &on_links)
                    .map_err(|reason| SolveError { element, reason })?;
                let r1 = r1.moved(-gap12);
                pass(reaction(carrier2, second, joint2, r2), gap2, &mut loads);
                pass(reaction(first, second, joint12, r12), gap12, &mut loads);
                pass(reaction(carrier1, first, joint1, r1), gap1, &mut loads);
            } else {
                let link = &motion.links[first.0];
                let (at, axis) = (link.origin.position, link.axis);
                let wrench = -loads[first.0];
                let (joint, drive) = match definition.group {
                    Group::Slider { .. } => {
                        (Joint::Prismatic { at, axis }, wrench.force.dot(&axis))
                    }
                    _ => (Joint::Revolute { at }, wrench.moment_about(at)),
                };
                driving.push(drive);
                pass(reaction(carrier1, first, joint, wrench), gap1, &mut loads);
            }
        }
        driving.reverse();
        backwards.reverse();
        Ok(Forces {
            driving,
            reactions: backwards,
            frame: loads[LinkId::GROUND.0],
        })
    }

    /// For each joint the link that exerts the reaction and the link on which it acts, in the
    /// order of [`Forces::reactions`].
    pub fn joint_links(&self) -> impl Iterator<Item = (LinkId, LinkId)> + '_ {
        self.elements.iter().flat_map(|element| {
            let first = element.first_link;
            let [carrier1, carrier2] = self.carriers(&element.group);
            let second = LinkId(first.0 + 1);
            let count = if element.group.is_driven() { 1 } else { 3 };
            let joints = [(carrier1, first), (first, second), (carrier2, second)];
            joints.into_iter().take(count)
        })
    }

    /// Weight, inertia force and external forces on each link.
    fn loads(&self, motion: &LinkageMotion<S>) -> Vec<Wrench<S>> {
        let mut loads: Vec<_> = self
            .links
            .iter()
            .zip(&motion.links)
            .map(|(link, motion)| {
                let inertia = &link.inertia;
                let com = motion.local_point(inertia.com);
                let force = (self.gravity - com.acceleration) * inertia.mass;
                Wrench::at(com.position, force) + Wrench::couple(-inertia.inertia * motion.alpha)
            })
            .collect();
        for (point, motion) in self.points.iter().zip(&motion.points) {
            let force = point.force + (self.gravity - motion.acceleration) * point.mass;
            let LinkId(link) = point.link;
            loads[link] = loads[link] + Wrench::at(motion.position, force);
        }
        loads
    }

    /// The links that carry a group's first and second outer joint; for a driven link,
    /// its carrier twice.
    fn carriers(&self, group: &Group<S>) -> [LinkId; 2] {
        let points = match group {
            Group::Crank { pivot } => [*pivot; 2],
            Group::Slider { guide } => [guide.through; 2],
            Group::Rrr { ends, .. } | Group::Rpr { ends, .. } => *ends,
            Group::Rrp { end, guide, .. } | Group::Rpp { end, guide, .. } => [*end, guide.through],
            Group::Prp { guides, .. } => guides.map(|guide| guide.through),
        };
        points.map(|point| self.points[point.0].link)
    }
}
