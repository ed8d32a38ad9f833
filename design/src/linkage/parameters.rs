//! The parameters of a linkage one by one, for listing, perturbing or differentiating.

use super::clearance::Clearance;
use super::dyad::{Prp, Rpp, Rpr, Rrp, Rrr};
use super::group::{Group, Guide};
use super::model::{Element, Linkage, NamedLink, Point};
use super::section::BarSection;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::dynamics::Link;
use nalgebra::Vector2;

/// What a parameter measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ParameterKind {
    /// Gravity, component 0 or 1 [m/s²].
    Gravity(usize),
    /// The length of a dyad's link [m].
    Length,
    /// The offset of a slider, or of a bar that is a guide, from its pin [m].
    Offset,
    /// Coordinate 0 or 1 of a point in its link's frame [m].
    Local(usize),
    /// A link's mass, or a point mass [kg].
    Mass,
    /// Coordinate 0 or 1 of a link's centre of mass [m].
    CentreOfMass(usize),
    /// A link's moment of inertia [kg·m²].
    Inertia,
    /// Component 0 or 1 of the external force on a point [N].
    Force(usize),
    /// The area of a bar's section [m²]. The inertia of such a link is computed from this
    /// area and the length.
    Section,
    /// r, the clearance of an element's joint 0, 1 or 2 [m].
    Clearance(usize),
    /// a, the direction of that clearance [rad].
    ClearanceAngle(usize),
}

/// A parameter of a linkage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameter<'a> {
    /// The name of the link or point to which it belongs; for a clearance the name of the
    /// element's first link; empty for gravity.
    pub part: &'a str,
    /// What it measures, with the unit.
    pub kind: ParameterKind,
}

impl<S: Scalar> Linkage<S> {
    /// The same linkage with every parameter replaced by the result of `f`. The order of the
    /// parameters depends only on the linkage's structure.
    ///
    /// With dual numbers this seeds a derivative; with `T = S` it perturbs a dimension.
    /// The directions of guides do not change.
    pub fn map_parameters<'a, T: Scalar>(
        &'a self,
        mut f: impl FnMut(Parameter<'a>, S) -> T,
    ) -> Linkage<T> {
        let gravity = pair(&mut f, "", ParameterKind::Gravity, self.gravity);
        let mut links = Vec::with_capacity(self.links.len());
        for NamedLink {
            name,
            inertia,
            section,
        } in &self.links
        {
            let mut one = |kind, value| f(Parameter { part: name, kind }, value);
            let section = section.map(|section| BarSection {
                area: one(ParameterKind::Section, section.area),
                density: constant_number(section.density),
            });
            let mass = one(ParameterKind::Mass, inertia.mass);
            let moment = one(ParameterKind::Inertia, inertia.inertia);
            links.push(NamedLink {
                name: name.clone(),
                inertia: Link {
                    mass,
                    com: pair(&mut f, name, ParameterKind::CentreOfMass, inertia.com),
                    inertia: moment,
                },
                section,
            });
        }
        let mut points = Vec::with_capacity(self.points.len());
        for point in &self.points {
            let name = &point.name;
            let mass = Parameter {
                part: name,
                kind: ParameterKind::Mass,
            };
            points.push(Point {
                name: name.clone(),
                link: point.link,
                local: point
                    .local
                    .map(|local| pair(&mut f, name, ParameterKind::Local, local)),
                mass: f(mass, point.mass),
                force: pair(&mut f, name, ParameterKind::Force, point.force),
            });
        }
        let mut elements = Vec::with_capacity(self.elements.len());
        for element in &self.elements {
            let links: Vec<_> = element.links().collect();
            let mut one = |link: usize, kind, value| {
                let part = &self.links[links[link].0].name;
                f(Parameter { part, kind }, value)
            };
            elements.push(Element {
                group: map_group(&element.group, &mut one),
                first_link: element.first_link,
                inner_pin: element.inner_pin,
                clearances: [0, 1, 2].map(|k| {
                    element.clearances[k].map(|Clearance { radius, angle }| Clearance {
                        radius: one(0, ParameterKind::Clearance(k), radius),
                        angle: one(0, ParameterKind::ClearanceAngle(k), angle),
                    })
                }),
            });
        }
        let mut linkage = Linkage {
            gravity,
            links,
            points,
            elements,
            steps: self.steps.clone(),
        };
        linkage.update_bar_inertias();
        linkage
    }

    /// The parameters with their values, in the order of [`Self::map_parameters`].
    pub fn parameters(&self) -> Vec<(Parameter<'_>, S)> {
        let mut parameters = Vec::new();
        self.map_parameters(|parameter, value| {
            parameters.push((parameter, value));
            value
        });
        parameters
    }
}

fn pair<'a, S: Scalar, T: Scalar>(
    f: &mut impl FnMut(Parameter<'a>, S) -> T,
    part: &'a str,
    kind: impl Fn(usize) -> ParameterKind,
    value: Vector2<S>,
) -> Vector2<T> {
    let mut one = |index, value| {
        let kind = kind(index);
        f(Parameter { part, kind }, value)
    };
    Vector2::new(one(0, value.x), one(1, value.y))
}

/// `one` gets the index, in the element, of the link to which a parameter belongs.
fn map_group<S: Scalar, T: Scalar>(
    group: &Group<S>,
    mut one: impl FnMut(usize, ParameterKind, S) -> T,
) -> Group<T> {
    match *group {
        Group::Crank { pivot } => Group::Crank { pivot },
        Group::Slider { guide } => Group::Slider {
            guide: constant_guide(guide),
        },
        Group::Rrr { dyad, ends } => Group::Rrr {
            dyad: Rrr {
                lengths: [
                    one(0, ParameterKind::Length, dyad.lengths[0]),
                    one(1, ParameterKind::Length, dyad.lengths[1]),
                ],
                side: dyad.side,
            },
            ends,
        },
        Group::Rrp { dyad, end, guide } => Group::Rrp {
            dyad: Rrp {
                length: one(0, ParameterKind::Length, dyad.length),
                offset: one(1, ParameterKind::Offset, dyad.offset),
                branch: dyad.branch,
            },
            end,
            guide: constant_guide(guide),
        },
        Group::Rpr { dyad, ends } => Group::Rpr {
            dyad: Rpr {
                offset: one(0, ParameterKind::Offset, dyad.offset),
                branch: dyad.branch,
            },
            ends,
        },
        Group::Prp { dyad, guides } => Group::Prp {
            dyad: Prp {
                offsets: [
                    one(0, ParameterKind::Offset, dyad.offsets[0]),
                    one(1, ParameterKind::Offset, dyad.offsets[1]),
                ],
            },
            guides: guides.map(constant_guide),
        },
        Group::Rpp { dyad, end, guide } => Group::Rpp {
            dyad: Rpp {
                direction: constant(dyad.direction),
            },
            end,
            guide: constant_guide(guide),
        },
    }
}

fn constant_number<S: Scalar, T: Scalar>(value: S) -> T {
    T::from_f64(value.to_f64())
}

fn constant<S: Scalar, T: Scalar>(vector: Vector2<S>) -> Vector2<T> {
    Vector2::new(constant_number(vector.x), constant_number(vector.y))
}

fn constant_guide<S: Scalar, T: Scalar>(guide: Guide<S>) -> Guide<T> {
    Guide {
        through: guide.through,
        direction: constant(guide.direction),
    }
}
