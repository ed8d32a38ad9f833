//! A linkage as vector loops, one for each dyad: so Shi 2005's analytic matrices can be
//! computed for any linkage and compared with the dual numbers.
//!
//! Every point is a chain of terms from the plane's origin; a dyad closes the chains of its
//! two ends. Its two unknowns are
//!
//! | dyad | unknowns | loop |
//! |---|---|---|
//! | RRR | φ1, φ2 | P1 + l1 e^{iφ1} = P2 + l2 e^{iφ2} |
//! | RRP | φ1, s | P1 + l e^{iφ1} = G + i e e^{iγ} + s e^{iγ} |
//! | RPR | φ, s | P1 + s e^{iφ} + i e e^{iφ} = P2 |
//! | PRP | s1, s2 | G1 + (s1 + i e1) e^{iγ1} = G2 + (s2 + i e2) e^{iγ2} |
//! | RPP | s, t | P1 = K + s e^{iγ} + t e^{i(γ+δ)} |
//!
//! and a clearance r e^{ia} is one more term of the chain it lies in.

use super::loops::{LoopQuantity, Term, TimeDerivatives, VectorLoops};
use crate::linkage::{Clearance, Coordinate, Group, Guide, Linkage, LinkageMotion, PointId};
use core::f64::consts::FRAC_PI_2;
use fivebar_kinematics::PlanarVector;
use nalgebra::DVector;

/// A direction: the sum of an angle that may change and a constant.
#[derive(Clone, Copy)]
struct Direction {
    angle: LoopQuantity,
    angle_offset: f64,
}

impl Direction {
    fn turned(self, by: f64) -> Self {
        Self {
            angle_offset: self.angle_offset + by,
            ..self
        }
    }

    fn term(self, length: LoopQuantity) -> Term {
        Term {
            sign: 1.0,
            length,
            angle: self.angle,
            angle_offset: self.angle_offset,
        }
    }
}

/// A link's frame: its direction and the chain to its origin.
#[derive(Clone)]
struct Frame {
    direction: Direction,
    origin: Vec<Term>,
}

/// The frames and pins that are expressed by terms so far. `numbers` is the linkage with each
/// parameter replaced by its index in the order of [`Linkage::map_parameters`].
struct Chains<'a> {
    numbers: &'a Linkage<f64>,
    frames: Vec<Frame>,
    inner_pins: Vec<Option<Vec<Term>>>,
}

impl Chains<'_> {
    /// The chain to a point.
    fn point(&self, id: PointId) -> Vec<Term> {
        if let Some(chain) = &self.inner_pins[id.index()] {
            return chain.clone();
        }
        let point = &self.numbers.points()[id.index()];
        let Frame { direction, origin } = &self.frames[point.link.index()];
        let mut chain = origin.clone();
        if let Some(local) = point.local {
            chain.push(direction.term(parameter(local.x)));
            chain.push(direction.turned(FRAC_PI_2).term(parameter(local.y)));
        }
        chain
    }

    fn guide(&self, guide: &Guide<f64>) -> Frame {
        let link = self.numbers.points()[guide.through.index()].link;
        let direction = self.frames[link.index()].direction;
        Frame {
            direction: direction.turned(guide.direction.polar_angle()),
            origin: self.point(guide.through),
        }
    }
}

/// The parameter with the index that the numbered linkage holds.
fn parameter(number: f64) -> LoopQuantity {
    LoopQuantity::Parameter(number as usize)
}

fn gap(clearance: Option<Clearance<f64>>) -> Option<Term> {
    clearance.map(|Clearance { radius, angle }| Term {
        sign: 1.0,
        length: parameter(radius),
        angle: parameter(angle),
        angle_offset: 0.0,
    })
}

/// The chain, continued by `more`.
fn and(mut chain: Vec<Term>, more: impl IntoIterator<Item = Term>) -> Vec<Term> {
    chain.extend(more);
    chain
}

impl VectorLoops {
    /// The loops of a linkage, all its parameters in the order of [`Linkage::map_parameters`];
    /// none if the carrier of a crank turns, because the crank's angle is then a sum of two.
    pub fn from_linkage(linkage: &Linkage<f64>) -> Option<Self> {
        let mut parameters = Vec::new();
        let numbers = linkage.map_parameters(|_, value: f64| {
            parameters.push(value);
            (parameters.len() - 1) as f64
        });
        let ground = Frame {
            direction: Direction {
                angle: LoopQuantity::Constant(0.0),
                angle_offset: 0.0,
            },
            origin: Vec::new(),
        };
        let mut chains = Chains {
            numbers: &numbers,
            frames: vec![ground],
            inner_pins: vec![None; linkage.points().len()],
        };
        let mut loops = Vec::new();
        let mut inputs = 0;
        let mut clearances = numbers.clearances();
        for element in numbers.elements() {
            let count = element.group.pins().len();
            let gaps: Vec<_> = clearances.by_ref().take(count).map(gap).collect();
            let input = LoopQuantity::Input(inputs);
            if let Group::Crank { pivot } = &element.group {
                let carrier = numbers.points()[pivot.index()].link;
                let angle_offset = match chains.frames[carrier.index()].direction {
                    Direction {
                        angle: LoopQuantity::Constant(angle),
                        angle_offset,
                    } => angle + angle_offset,
                    _ => return None,
                };
                let origin = and(chains.point(*pivot), gaps[0]);
                let direction = Direction {
                    angle: input,
                    angle_offset,
                };
                chains.frames.push(Frame { direction, origin });
                inputs += 1;
                continue;
            }
            if let Group::Slider { guide } = &element.group {
                let mut frame = chains.guide(guide);
                frame.origin.push(frame.direction.term(input));
                chains.frames.push(frame);
                inputs += 1;
                continue;
            }
            let first = LoopQuantity::Unknown(2 * loops.len());
            let second = LoopQuantity::Unknown(2 * loops.len() + 1);
            // The chains to the inner joint along either link, and the two links' frames.
            let ([along1, along2], frames) = dyad(&chains, &element.group, [first, second], &gaps);
            if let Some(pin) = element.inner_pin() {
                chains.inner_pins[pin.index()] = Some(along1.clone());
            }
            let against = along2.into_iter().map(|term| Term {
                sign: -term.sign,
                ..term
            });
            loops.push(and(and(along1, gaps[1]), against));
            chains.frames.extend(frames);
        }
        drop(clearances);
        Some(Self {
            loops,
            inputs,
            parameters,
        })
    }
}

type Sides = ([Vec<Term>; 2], [Frame; 2]);

fn dyad(
    chains: &Chains<'_>,
    group: &Group<f64>,
    [first, second]: [LoopQuantity; 2],
    gaps: &[Option<Term>],
) -> Sides {
    let free = |angle| Direction {
        angle,
        angle_offset: 0.0,
    };
    let end = |point: PointId, k: usize| and(chains.point(point), gaps[k]);
    // A slider `offset` beside its guide and `slide` along it.
    let slid = |guide: &Guide<f64>, offset: f64, slide: LoopQuantity| {
        let Frame { direction, origin } = chains.guide(guide);
        let beside = direction.turned(FRAC_PI_2).term(parameter(offset));
        let origin = and(origin, [beside, direction.term(slide)]);
        Frame { direction, origin }
    };
    let bar = |origin: Vec<Term>, direction: Direction| Frame { direction, origin };
    match group {
        Group::Rrr { dyad, ends } => {
            let frames = [
                bar(end(ends[0], 0), free(first)),
                bar(end(ends[1], 2), free(second)),
            ];
            let along = |k: usize| {
                let Frame { direction, origin } = frames[k].clone();
                and(origin, [direction.term(parameter(dyad.lengths[k]))])
            };
            ([along(0), along(1)], frames)
        }
        Group::Rrp {
            dyad,
            end: on,
            guide,
        } => {
            let link = bar(end(*on, 0), free(first));
            let slider = slid(guide, dyad.offset, second);
            let length = link.direction.term(parameter(dyad.length));
            let along = and(link.origin.clone(), [length]);
            ([along, slider.origin.clone()], [link, slider])
        }
        Group::Rpr { dyad, ends } => {
            let direction = free(first);
            let link = bar(end(ends[0], 0), direction);
            let slider = bar(end(ends[1], 2), direction);
            let beside = direction.turned(FRAC_PI_2).term(parameter(dyad.offset));
            let along = and(link.origin.clone(), [direction.term(second), beside]);
            ([along, slider.origin.clone()], [link, slider])
        }
        Group::Prp { dyad, guides } => {
            let [e1, e2] = dyad.offsets;
            let sliders = [slid(&guides[0], e1, first), slid(&guides[1], e2, second)];
            (sliders.clone().map(|slider| slider.origin), sliders)
        }
        Group::Rpp {
            dyad,
            end: on,
            guide,
        } => {
            let Frame { direction, origin } = chains.guide(guide);
            let slider = bar(and(origin, [direction.term(first)]), direction);
            let direction = direction.turned(dyad.direction.polar_angle());
            let link = bar(end(*on, 0), direction);
            let along = and(slider.origin.clone(), [direction.term(second)]);
            ([link.origin.clone(), along], [link, slider])
        }
        Group::Crank { .. } | Group::Slider { .. } => unreachable!("a driven link has no loop"),
    }
}

/// U, U̇ and Ü of a linkage's loops, two for each dyad, from its motion.
pub fn unknowns<S: fivebar_kinematics::Scalar>(
    linkage: &Linkage<S>,
    motion: &LinkageMotion<S>,
) -> Vec<Coordinate<S>> {
    let mut unknowns = Vec::new();
    for (element, dyad) in linkage.elements().iter().zip(&motion.dyads) {
        let Some(dyad) = dyad else { continue };
        let [angle1, angle2] = dyad.links.map(|link| Coordinate {
            value: link.axis.polar_angle(),
            rate: link.omega,
            acceleration: link.alpha,
        });
        let slides = dyad.slides.into_iter().flatten();
        match element.group {
            Group::Rrr { .. } => unknowns.extend([angle1, angle2]),
            Group::Rrp { .. } | Group::Rpr { .. } => {
                unknowns.push(angle1);
                unknowns.extend(slides);
            }
            _ => unknowns.extend(slides),
        }
    }
    unknowns
}

/// The coordinates' values, rates and accelerations as columns.
pub fn time_derivatives(coordinates: &[Coordinate<f64>]) -> TimeDerivatives {
    let column = |part: fn(&Coordinate<f64>) -> f64| {
        DVector::from_iterator(coordinates.len(), coordinates.iter().map(part))
    };
    TimeDerivatives {
        value: column(|c| c.value),
        rate: column(|c| c.rate),
        acceleration: column(|c| c.acceleration),
    }
}
