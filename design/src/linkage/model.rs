//! The linkage: its links, points, driven links and dyads, added one by one.
//!
//! Each part may be carried only by parts that were added before it. So every linkage can be
//! solved in the order in which it was built.

use super::check::{LinkageError, finite, not_negative};
use super::clearance::Clearance;
use super::group::{Group, LinkId, PointId};
use super::section::BarSection;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::dynamics::Link;
use nalgebra::Vector2;

/// A group of a linkage, with its links.
#[derive(Clone, Debug, PartialEq)]
pub struct Element<S> {
    /// The driven link or dyad.
    pub group: Group<S>,
    pub(super) first_link: LinkId,
    pub(super) inner_pin: Option<PointId>,
    /// The clearances of its pins, in the order of its joints.
    pub(super) clearances: [Option<Clearance<S>>; 3],
}

impl<S> Element<S> {
    /// The driven link, or the dyad's two links in its order.
    pub fn links(&self) -> impl Iterator<Item = LinkId> + Clone + use<S> {
        let first = self.first_link.0;
        let count = if self.group.is_driven() { 1 } else { 2 };
        (first..first + count).map(LinkId)
    }

    /// The driven link, or the dyad's first link.
    pub fn first_link(&self) -> LinkId {
        self.first_link
    }

    /// The inner pin of RRR, RRP and PRP, a point of the dyad's first link; none for others.
    pub fn inner_pin(&self) -> Option<PointId> {
        self.inner_pin
    }
}

/// A named point of a link.
#[derive(Clone, Debug, PartialEq)]
pub struct Point<S> {
    /// Its name.
    pub name: String,
    /// The link to which it belongs; forces at the point act on this link.
    pub link: LinkId,
    /// Its coordinates in that link's frame [m]; none for a dyad's inner pin.
    pub local: Option<Vector2<S>>,
    /// A point mass carried there [kg].
    pub mass: S,
    /// An external force on it [N], in the plane's frame.
    pub force: Vector2<S>,
}

/// A named link with its inertia.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedLink<S> {
    /// Its name.
    pub name: String,
    /// Its mass, centre of mass in its own frame, and moment of inertia.
    pub inertia: Link<S>,
    /// The section of a slender bar, from which its inertia is computed; none for other links.
    pub section: Option<BarSection<S>>,
}

/// One step of the solution; the steps are in the order in which the linkage was built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SolutionStep {
    Element(usize),
    Point(usize),
}

/// Driven links, dyads and points, each carried by earlier ones.
///
/// ```
/// use fivebar_design::linkage::dyad::Rrr;
/// use fivebar_design::linkage::{Coordinate, Group, LinkId, Linkage};
/// use fivebar_kinematics::five_bar::Side;
/// use nalgebra::Vector2;
///
/// // A four-bar: a crank of 60 mm, a coupler of 180 mm and a rocker of 140 mm.
/// let mut linkage = Linkage::new(Vector2::zeros())?;
/// let a = linkage.add_point("A", LinkId::GROUND, Vector2::zeros())?;
/// let d = linkage.add_point("D", LinkId::GROUND, Vector2::new(0.20, 0.0))?;
/// let crank = linkage.add_group("crank", Group::Crank { pivot: a })?;
/// let b = linkage.add_point("B", crank.first_link(), Vector2::new(0.06_f64, 0.0))?;
/// let dyad = Rrr { lengths: [0.18, 0.14], side: Side::Left };
/// linkage.add_group("C", Group::Rrr { dyad, ends: [b, d] })?;
///
/// let input = Coordinate { value: 1.0, rate: 10.0, acceleration: 0.0 }; // rad, rad/s, rad/s²
/// let motion = linkage.motion(&[input])?;
/// assert!((motion.points[b.index()].velocity.norm() - 0.6).abs() < 1e-15); // m/s
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Linkage<S> {
    pub(super) gravity: Vector2<S>,
    pub(super) links: Vec<NamedLink<S>>,
    pub(super) points: Vec<Point<S>>,
    pub(super) elements: Vec<Element<S>>,
    pub(super) steps: Vec<SolutionStep>,
}

impl<S: Scalar> Linkage<S> {
    /// A linkage that has a frame and no other link, with `gravity` [m/s²] in the plane.
    ///
    /// # Errors
    /// `NotFinite`.
    pub fn new(gravity: Vector2<S>) -> Result<Self, LinkageError> {
        finite(gravity)?;
        let mut linkage = Self {
            gravity,
            links: Vec::new(),
            points: Vec::new(),
            elements: Vec::new(),
            steps: Vec::new(),
        };
        linkage.push_link("ground");
        Ok(linkage)
    }

    /// Adds a point to a link, at `local` [m] in the link's frame.
    ///
    /// # Errors
    /// `NotFinite`.
    ///
    /// # Panics
    /// If the link does not exist in this linkage.
    pub fn add_point(
        &mut self,
        name: &str,
        link: LinkId,
        local: Vector2<S>,
    ) -> Result<PointId, LinkageError> {
        assert!(link.0 < self.links.len(), "the link is of another linkage");
        finite(local)?;
        Ok(self.push_point(name, link, Some(local)))
    }

    /// Adds a driven link or a dyad. A dyad with an inner pin gets a point there; the point
    /// and the new links have the element's `name`. The links are massless; see
    /// [`Linkage::set_link`].
    ///
    /// # Errors
    /// `Length`, `Direction` or `NotFinite`.
    pub fn add_group(&mut self, name: &str, group: Group<S>) -> Result<Element<S>, LinkageError> {
        let group = group.validated()?;
        let first_link = self.push_link(name);
        if !group.is_driven() {
            self.push_link(name);
        }
        self.steps.push(SolutionStep::Element(self.elements.len()));
        let has_pin = matches!(
            group,
            Group::Rrr { .. } | Group::Rrp { .. } | Group::Prp { .. }
        );
        let inner_pin = has_pin.then(|| self.push_point(name, first_link, None));
        let element = Element {
            group,
            first_link,
            inner_pin,
            clearances: [None; 3],
        };
        self.elements.push(element.clone());
        Ok(element)
    }

    /// Names a link and gives it mass.
    ///
    /// # Errors
    /// `Inertia`, `NotFinite`.
    ///
    /// # Panics
    /// If the link does not exist in this linkage.
    pub fn set_link(
        &mut self,
        link: LinkId,
        name: &str,
        inertia: Link<S>,
    ) -> Result<(), LinkageError> {
        not_negative(inertia.mass)?;
        not_negative(inertia.inertia)?;
        finite(inertia.com)?;
        self.links[link.0] = NamedLink {
            name: name.into(),
            inertia,
            section: None,
        };
        Ok(())
    }

    /// Puts a point mass [kg] and an external force [N] on a point.
    ///
    /// # Errors
    /// `Inertia`, `NotFinite`.
    ///
    /// # Panics
    /// If the point does not exist in this linkage.
    pub fn set_load(
        &mut self,
        point: PointId,
        mass: S,
        force: Vector2<S>,
    ) -> Result<(), LinkageError> {
        not_negative(mass)?;
        finite(force)?;
        let point = &mut self.points[point.0];
        point.mass = mass;
        point.force = force;
        Ok(())
    }

    fn push_link(&mut self, name: &str) -> LinkId {
        let inertia = Link {
            mass: S::ZERO,
            com: Vector2::zeros(),
            inertia: S::ZERO,
        };
        self.links.push(NamedLink {
            name: name.into(),
            inertia,
            section: None,
        });
        LinkId(self.links.len() - 1)
    }

    fn push_point(&mut self, name: &str, link: LinkId, local: Option<Vector2<S>>) -> PointId {
        let id = PointId(self.points.len());
        if local.is_some() {
            self.steps.push(SolutionStep::Point(id.0));
        }
        self.points.push(Point {
            name: name.into(),
            link,
            local,
            mass: S::ZERO,
            force: Vector2::zeros(),
        });
        id
    }

    /// Gravity in the plane [m/s²].
    pub fn gravity(&self) -> Vector2<S> {
        self.gravity
    }
    /// The links, the ground first.
    pub fn links(&self) -> &[NamedLink<S>] {
        &self.links
    }
    /// The points.
    pub fn points(&self) -> &[Point<S>] {
        &self.points
    }
    /// The driven links and dyads, in the order of solution.
    pub fn elements(&self) -> &[Element<S>] {
        &self.elements
    }
    /// The driven links, in the order of their coordinates.
    pub fn driven_links(&self) -> impl Iterator<Item = LinkId> + '_ {
        let driven = |element: &&Element<S>| element.group.is_driven();
        self.elements.iter().filter(driven).map(Element::first_link)
    }
    /// The number of its driving coordinates, one for each driven link.
    pub fn degrees_of_freedom(&self) -> usize {
        self.driven_links().count()
    }
}
