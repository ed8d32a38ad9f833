//! Positions, velocities and accelerations of the whole linkage.

use super::dyad::{DyadError, DyadMotion};
use super::group::{Group, Guide, LinkId};
use super::model::{Linkage, SolutionStep};
use super::motion::{Coordinate, LinkMotion, PointMotion};
use core::fmt;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Position and motion of all links and points of a linkage at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkageMotion<S> {
    /// The links, in the order of [`Linkage::links`].
    pub links: Vec<LinkMotion<S>>,
    /// The points, in the order of [`Linkage::points`].
    pub points: Vec<PointMotion<S>>,
    /// The dyads, in the order of [`Linkage::elements`]; none for a driven link.
    pub dyads: Vec<Option<DyadMotion<S>>>,
}

/// The element that has no solution, and the reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolveError {
    /// Its index in [`Linkage::elements`].
    pub element: usize,
    /// Why the dyad cannot be solved.
    pub reason: DyadError,
}

impl fmt::Display for SolveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "element {} {}", self.element + 1, self.reason)
    }
}

impl core::error::Error for SolveError {}

impl<S: Scalar> LinkageMotion<S> {
    /// Storage for the motion of `linkage`, for [`Linkage::solve`].
    pub fn new(linkage: &Linkage<S>) -> Self {
        Self {
            links: vec![LinkMotion::ground(); linkage.links.len()],
            points: vec![PointMotion::fixed(Vector2::zeros()); linkage.points.len()],
            dyads: vec![None; linkage.elements.len()],
        }
    }

    /// The motion of a guide.
    fn guide(&self, linkage: &Linkage<S>, guide: &Guide<S>) -> LinkMotion<S> {
        let through = guide.through.0;
        let LinkId(link) = linkage.points[through].link;
        self.links[link].guide(&self.points[through], guide.direction)
    }
}

impl<S: Scalar> Linkage<S> {
    /// The motion for these driving coordinates, one for each driven link in order.
    ///
    /// # Errors
    /// The first dyad that is out of reach or singular.
    ///
    /// # Panics
    /// If the number of coordinates differs from the number of driven links.
    pub fn motion(&self, inputs: &[Coordinate<S>]) -> Result<LinkageMotion<S>, SolveError> {
        let mut motion = LinkageMotion::new(self);
        self.solve(inputs, &mut motion)?;
        Ok(motion)
    }

    /// As [`Linkage::motion`], into existing storage, which saves the allocation. After an
    /// error the content of `motion` is not valid.
    ///
    /// # Errors
    /// As [`Linkage::motion`].
    ///
    /// # Panics
    /// As [`Linkage::motion`], and if `motion` is of another linkage.
    pub fn solve(
        &self,
        inputs: &[Coordinate<S>],
        motion: &mut LinkageMotion<S>,
    ) -> Result<(), SolveError> {
        assert_eq!(
            inputs.len(),
            self.degrees_of_freedom(),
            "one input for each driven link"
        );
        let mut inputs = inputs.iter();
        for step in &self.steps {
            match *step {
                SolutionStep::Point(index) => {
                    let point = &self.points[index];
                    if let Some(local) = point.local {
                        motion.points[index] = motion.links[point.link.0].local_point(local);
                    }
                }
                SolutionStep::Element(index) => self.solve_element(index, &mut inputs, motion)?,
            }
        }
        Ok(())
    }

    fn solve_element<'a>(
        &self,
        index: usize,
        inputs: &mut impl Iterator<Item = &'a Coordinate<S>>,
        motion: &mut LinkageMotion<S>,
    ) -> Result<(), SolveError> {
        let element = &self.elements[index];
        let [gap1, gap12, gap2] = element.clearance_offsets();
        // Link 1 is solved with its inner pin at that of link 2, then shifted back.
        let gap1 = gap1 + gap12;
        let solved = match &element.group {
            Group::Crank { pivot } => {
                if let Some(input) = inputs.next() {
                    let carrier = &motion.links[self.points[pivot.0].link.0];
                    let pivot = motion.points[pivot.0].moved(gap1);
                    let crank = turned(carrier, &pivot, input);
                    motion.links[element.first_link.0] = crank;
                }
                return Ok(());
            }
            Group::Slider { guide } => {
                if let Some(input) = inputs.next() {
                    let guide = motion.guide(self, guide);
                    motion.links[element.first_link.0] = guide.slider_at(input);
                }
                return Ok(());
            }
            Group::Rrr { dyad, ends } => {
                let [end1, end2] = ends.map(|end| motion.points[end.0]);
                dyad.motion(&end1.moved(gap1), &end2.moved(gap2))
            }
            Group::Rrp { dyad, end, guide } => dyad.motion(
                &motion.points[end.0].moved(gap1),
                &motion.guide(self, guide),
            ),
            Group::Rpr { dyad, ends } => {
                let [end1, end2] = ends.map(|end| motion.points[end.0]);
                dyad.motion(&end1.moved(gap1), &end2.moved(gap2))
            }
            Group::Prp { dyad, guides } => {
                let [guide1, guide2] = guides.map(|guide| motion.guide(self, &guide));
                dyad.motion(&guide1.moved(gap1), &guide2)
            }
            Group::Rpp { dyad, end, guide } => dyad.motion(
                &motion.points[end.0].moved(gap1),
                &motion.guide(self, guide),
            ),
        };
        let mut dyad = solved.map_err(|reason| SolveError {
            element: index,
            reason,
        })?;
        dyad.links[0] = dyad.links[0].moved(-gap12);
        dyad.joints[0] = dyad.joints[0].moved(-gap12);
        for (link, solved) in element.links().zip(dyad.links) {
            motion.links[link.0] = solved;
        }
        if let Some(pin) = element.inner_pin {
            // The inner pin is a point of link 1.
            dyad.inner_point = dyad.inner_point.moved(-gap12);
            motion.points[pin.0] = dyad.inner_point;
        }
        motion.dyads[index] = Some(dyad);
        Ok(())
    }
}

/// A link that is turned by `angle` relative to its carrier, about `pivot`.
fn turned<S: Scalar>(
    carrier: &LinkMotion<S>,
    pivot: &PointMotion<S>,
    angle: &Coordinate<S>,
) -> LinkMotion<S> {
    LinkMotion {
        origin: *pivot,
        axis: Vector2::unit(angle.value).to_base_frame(carrier.axis),
        omega: carrier.omega + angle.rate,
        alpha: carrier.alpha + angle.acceleration,
    }
}
