//! Positions, motion, driving forces and joint reactions of a linkage as functions of its
//! inputs and their rates, lengths, coordinates, masses, sections, clearances and the
//! directions of the clearances.

mod analysis;
mod point_error;
mod tolerance;

pub use analysis::{
    LinkageAnalysis, LinkageStudy, TolerancedLinkage, analyse_linkage, sample_linkage,
    study_linkage,
};
pub use point_error::PointError;
pub use tolerance::{LinkageTolerance, PinTolerance};

use super::DifferentiableModel;
use crate::linkage::{
    Clearance, Coordinate, Linkage, LinkageMotion, Parameter, ParameterKind, Reaction, SolveError,
};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::Scalar;

/// A linkage as a function of its inputs q, q̇, q̈ and of some of its parameters.
///
/// A link's moment of inertia scales with its mass, unless it is a parameter itself.
#[derive(Clone, Debug)]
pub struct LinkageAccuracyModel<'a> {
    /// The nominal linkage.
    pub linkage: &'a Linkage<f64>,
    /// The indices of the parameters that vary, in the order of [`Linkage::map_parameters`],
    /// ascending.
    pub varied: Vec<usize>,
}

/// The meaning of a result of a [`LinkageAccuracyModel`], with the index of the point, link or
/// joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResultKind {
    /// Component 0 or 1 of a point's position [m]; the point in [`Linkage::points`].
    Position(usize, usize),
    /// Of its velocity [m/s].
    Velocity(usize, usize),
    /// Of its acceleration [m/s²].
    Acceleration(usize, usize),
    /// A link's angle [rad]; the link in [`Linkage::links`].
    Angle(usize),
    /// Its angular velocity [rad/s].
    AngularVelocity(usize),
    /// Its angular acceleration [rad/s²].
    AngularAcceleration(usize),
    /// The torque [N·m] or force [N] of a driven link; the index counts driven links only.
    Drive(usize),
    /// Component 0 or 1 of a joint's force [N]; the joint in [`Linkage::joint_links`].
    Force(usize, usize),
    /// The moment in a joint about the joint's centre [N·m].
    Moment(usize),
}

impl LinkageAccuracyModel<'_> {
    /// The nominal values of the primitives: q, q̇, q̈, then the parameters that vary.
    pub fn primitives(&self, inputs: &[Coordinate<f64>]) -> Vec<f64> {
        let mut values: Vec<f64> = inputs.iter().map(|input| input.value).collect();
        values.extend(inputs.iter().map(|input| input.rate));
        values.extend(inputs.iter().map(|input| input.acceleration));
        let parameters = self.linkage.parameters();
        values.extend(self.varied.iter().map(|&index| parameters[index].1));
        values
    }

    /// The meaning of the results, in their order: of every moving point, every moving link,
    /// every driven link and every joint.
    pub fn result_kinds(&self) -> Vec<ResultKind> {
        let mut kinds = Vec::new();
        for point in moving(self.linkage) {
            for kind in [
                ResultKind::Position,
                ResultKind::Velocity,
                ResultKind::Acceleration,
            ] {
                kinds.extend([kind(point, 0), kind(point, 1)]);
            }
        }
        for link in 1..self.linkage.links().len() {
            kinds.extend([
                ResultKind::Angle(link),
                ResultKind::AngularVelocity(link),
                ResultKind::AngularAcceleration(link),
            ]);
        }
        kinds.extend((0..self.linkage.degrees_of_freedom()).map(ResultKind::Drive));
        for joint in 0..self.linkage.joint_links().count() {
            let force = [ResultKind::Force(joint, 0), ResultKind::Force(joint, 1)];
            kinds.extend(force);
            kinds.push(ResultKind::Moment(joint));
        }
        kinds
    }

    /// The linkage with these values of the parameters that vary.
    fn with<S: Scalar>(&self, parameters: &[S]) -> Linkage<S> {
        let mut number = 0;
        let mut varied = self.varied.iter().zip(parameters).peekable();
        let mut heavier = S::ONE;
        self.linkage
            .map_parameters(|Parameter { kind, .. }, nominal| {
                let given = varied.next_if(|&(&varied, _)| varied == number);
                number += 1;
                let value = given.map_or(S::from_f64(nominal), |(_, &value)| value);
                match kind {
                    ParameterKind::Mass => {
                        heavier = if nominal > 0.0 {
                            value / S::from_f64(nominal)
                        } else {
                            S::ONE
                        };
                        value
                    }
                    ParameterKind::Inertia if given.is_none() => value * heavier,
                    _ => value,
                }
            })
    }
}

/// The indices of the points that move.
fn moving<S: Scalar>(linkage: &Linkage<S>) -> impl Iterator<Item = usize> + '_ {
    let points = linkage.points().iter().enumerate();
    points
        .filter(|(_, point)| point.link.index() > 0)
        .map(|(index, _)| index)
}

impl DifferentiableModel for LinkageAccuracyModel<'_> {
    type Error = SolveError;

    fn evaluate<S: Scalar>(&self, primitives: &[S]) -> Result<Vec<S>, SolveError> {
        let freedoms = self.linkage.degrees_of_freedom();
        let (inputs, parameters) = primitives.split_at(3 * freedoms);
        let inputs: Vec<_> = (0..freedoms)
            .map(|i| Coordinate {
                value: inputs[i],
                rate: inputs[freedoms + i],
                acceleration: inputs[2 * freedoms + i],
            })
            .collect();
        let linkage = self.with(parameters);
        let motion = linkage.motion(&inputs)?;
        let forces = linkage.forces(&motion)?;
        let mut results = Vec::new();
        for point in moving(&linkage) {
            let point = &motion.points[point];
            for vector in [point.position, point.velocity, point.acceleration] {
                results.extend([vector.x, vector.y]);
            }
        }
        for link in motion.links.iter().skip(1) {
            results.extend([link.axis.polar_angle(), link.omega, link.alpha]);
        }
        results.extend(&forces.driving);
        for Reaction { joint, wrench, .. } in &forces.reactions {
            let moment = wrench.moment_about(joint.position());
            results.extend([wrench.force.x, wrench.force.y, moment]);
        }
        Ok(results)
    }
}

/// A linkage with its pins in clearance equilibrium: each rests where its reaction presses it.
#[derive(Clone, Debug)]
pub struct LinkageEquilibrium {
    /// The linkage with its clearances.
    pub linkage: Linkage<f64>,
    /// Its motion.
    pub motion: LinkageMotion<f64>,
    /// The number of iterations.
    pub iterations: usize,
    /// Whether the directions converged; otherwise a joint is about to lose contact.
    pub converged: bool,
}

/// The directions have converged when they change by less than this [rad].
const CONVERGED: f64 = 1e-11;
/// Directions that have not converged after so many iterations do not converge: the direction
/// of a force near zero alternates.
const MAX_ITERATIONS: usize = 60;

/// The clearance equilibrium of a linkage in motion (Tu 2005): in a joint of clearance r, the
/// link on which the force F acts is displaced by −r F̂ from the link that exerts it. `radii`
/// [m] are in the order of [`Linkage::joint_links`]. Slides are ignored; pins with a radius of
/// 0 keep the clearance that they have.
///
/// # Errors
/// Where the linkage cannot be solved.
pub fn clearance_equilibrium(
    linkage: &Linkage<f64>,
    inputs: &[Coordinate<f64>],
    radii: &[f64],
) -> Result<LinkageEquilibrium, SolveError> {
    let pins: Vec<bool> = linkage.pins().collect();
    let motion = linkage.motion(inputs)?;
    let mut equilibrium = LinkageEquilibrium {
        linkage: linkage.clone(),
        motion,
        iterations: 0,
        converged: false,
    };
    while equilibrium.iterations < MAX_ITERATIONS && !equilibrium.converged {
        let forces = equilibrium.linkage.forces(&equilibrium.motion)?;
        let before: Vec<_> = equilibrium.linkage.clearances().collect();
        let mut change = 0.0_f64;
        for (joint, reaction) in forces.reactions.iter().enumerate() {
            let radius = radii.get(joint).copied().unwrap_or(0.0);
            let force = reaction.wrench.force;
            if radius > 0.0 && pins[joint] {
                // Nothing presses where there is no force.
                let pressed = Clearance {
                    radius: if force.length() > 0.0 { radius } else { 0.0 },
                    angle: (-force).polar_angle(),
                };
                let turned = |from: Clearance<f64>| (pressed.offset() - from.offset()).length();
                change = change.max(before[joint].map_or(1.0, turned) / radius);
                // Never refused: the joint is a pin, the radius positive and the angle finite.
                let _ = equilibrium.linkage.set_clearance(joint, pressed);
            }
        }
        equilibrium.motion = equilibrium.linkage.motion(inputs)?;
        equilibrium.iterations += 1;
        equilibrium.converged = change <= CONVERGED;
    }
    Ok(equilibrium)
}
