//! Back up the chain: joint reactions and driving forces, dyad by dyad.
//!
//! Each link bears its weight, its inertia forces (d'Alembert) and what acts at its
//! points. A dyad is solved for its three reactions; the opposites of the two outer ones
//! then load the links that carry it, which are solved later. Last comes the frame.

use super::group::{Group, LinkId};
use super::joint::Joint;
use super::model::Linkage;
use super::solve::{LinkageMotion, SolveError};
use super::statics::reactions;
use super::wrench::Wrench;
use fivebar_kinematics::Scalar;
use nalgebra::Vector2;

/// What a joint passes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction<S> {
    /// The element whose joint it is, its place in [`Linkage::elements`].
    pub element: usize,
    /// The link that exerts it.
    pub from: LinkId,
    /// The link on which it acts.
    pub on: LinkId,
    /// The joint. A driven joint also passes on its driving torque or force.
    pub joint: Joint<S>,
    /// The force, and the moment about the plane's origin.
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
    /// What the linkage exerts on its frame: shaking force and moment, weight included.
    pub frame: Wrench<S>,
}

impl<S: Scalar> Linkage<S> {
    /// The forces that the motion needs, with gravity, the inertia of links and point
    /// masses, and the external forces on points. Joints without friction.
    ///
    /// # Errors
    /// None for a motion that [`Linkage::solve`] gave.
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
            // What a joint exerts on one link acts back on the other at that link's own place.
            let mut pass = |reaction: Reaction<S>, gap: Vector2<S>, loads: &mut [Wrench<S>]| {
                let LinkId(carrier) = reaction.from;
                loads[carrier] = loads[carrier] + -reaction.wrench.moved(-gap);
                backwards.push(reaction);
            };
            if let Some(dyad) = &motion.dyads[element] {
                let second = LinkId(first.0 + 1);
                let [joint1, joint12, joint2] = dyad.joints;
                // Link 1 with all its loads is brought to where its inner pin meets link 2's.
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

    /// Which link acts on which in each joint, in the order of [`Forces::reactions`].
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

    /// The links that carry a group's first and second outer joint; of a driven link,
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
