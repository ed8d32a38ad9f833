//! One mechanism in TOML: joints by kind, axis and point.

use super::{Mechanism, MobilityCase};
use crate::source::{FileError, Source};
use fivebar_design::mobility::{
    Freedom, Joint, MechanismError, MechanismGraph, ParallelMechanism, Screw,
};
use nalgebra::Vector3;
use serde::Deserialize;

/// The name by which joints refer to the base.
const GROUND: &str = "ground";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    #[serde(default)]
    description: String,
    #[serde(default)]
    limb: Vec<LimbEntry>,
    platform: Option<String>,
    #[serde(default)]
    joint: Vec<GraphEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LimbEntry {
    joints: Vec<JointEntry>,
}

#[derive(Deserialize)]
struct GraphEntry {
    between: [String; 2],
    // Flattening rules out deny_unknown_fields; JointEntry's own fields are checked there.
    #[serde(flatten)]
    joint: JointEntry,
}

#[derive(Deserialize)]
#[serde(tag = "kind", deny_unknown_fields)]
enum JointEntry {
    /// Revolute.
    R {
        axis: [f64; 3],
        point: [f64; 3],
        #[serde(default)]
        actuated: bool,
    },
    /// Prismatic.
    P {
        axis: [f64; 3],
        #[serde(default)]
        actuated: bool,
    },
    /// Helical, `pitch` in metres per radian.
    H {
        axis: [f64; 3],
        point: [f64; 3],
        pitch: f64,
        #[serde(default)]
        actuated: bool,
    },
    /// Cylindrical: R and P on one axis.
    C {
        axis: [f64; 3],
        point: [f64; 3],
        #[serde(default)]
        actuated: bool,
    },
    /// Universal: two crossing revolute axes.
    U {
        axis: [f64; 3],
        axis2: [f64; 3],
        point: [f64; 3],
        #[serde(default)]
        actuated: bool,
    },
    /// Spherical: three revolute axes through a point.
    S { point: [f64; 3] },
    /// A parallelogram as one joint: `rod` is the vector from its near to its far joint; it
    /// turns about `axis`.
    Pa {
        axis: [f64; 3],
        rod: [f64; 3],
        #[serde(default)]
        actuated: bool,
    },
}

/// The sine between two axes up to which they count as parallel.
const PARALLEL: f64 = 1e-6;

impl JointEntry {
    /// `name` says which joint it is.
    fn joint(
        &self,
        from: usize,
        to: usize,
        name: impl FnOnce() -> String,
    ) -> Result<Joint, DescriptionError> {
        let line = |axis: &[f64; 3], point: &[f64; 3]| {
            Freedom::Screw(Screw::line(Vector3::from(*axis), Vector3::from(*point)))
        };
        let slide = |axis: &[f64; 3]| Freedom::Screw(Screw::free(Vector3::from(*axis)));
        let (freedoms, actuated) = match self {
            Self::R {
                axis,
                point,
                actuated,
            } => (vec![line(axis, point)], *actuated),
            Self::P { axis, actuated } => (vec![slide(axis)], *actuated),
            Self::H {
                axis,
                point,
                pitch,
                actuated,
            } => {
                if !pitch.is_finite() {
                    return Err(DescriptionError::InfinitePitch(name()));
                }
                let screw = Screw::helix(Vector3::from(*axis), Vector3::from(*point), *pitch);
                (vec![Freedom::Screw(screw)], *actuated)
            }
            Self::C {
                axis,
                point,
                actuated,
            } => (vec![line(axis, point), slide(axis)], *actuated),
            Self::U {
                axis,
                axis2,
                point,
                actuated,
            } => {
                let axes = [axis, axis2].map(|axis| Vector3::from(*axis));
                let sizes = axes[0].norm() * axes[1].norm();
                if axes[0].cross(&axes[1]).norm() <= PARALLEL * sizes {
                    return Err(DescriptionError::ParallelAxes(name()));
                }
                (vec![line(axis, point), line(axis2, point)], *actuated)
            }
            Self::S { point } => {
                let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
                (axes.iter().map(|axis| line(axis, point)).collect(), false)
            }
            Self::Pa {
                axis,
                rod,
                actuated,
            } => {
                let freedom = Freedom::Parallelogram {
                    normal: Vector3::from(*axis),
                    rod: Vector3::from(*rod),
                };
                (vec![freedom], *actuated)
            }
        };
        Ok(Joint {
            from,
            to,
            freedoms,
            actuated,
        })
    }
}

pub(super) fn parse(source: &Source<'_>) -> Result<MobilityCase, FileError> {
    let file: File = source.parse_no_robot("a mechanism")?;
    let mechanism = mechanism(&file).map_err(|reason| FileError::new(source.file, reason))?;
    Ok(MobilityCase {
        name: file.name,
        description: file.description,
        mechanism,
    })
}

/// Why a file does not describe a mechanism.
#[derive(Debug, thiserror::Error)]
enum DescriptionError {
    #[error("give either [[limb]] or [[joint]], not both")]
    LimbsAndJoints,
    #[error("there is no [[limb]] and no [[joint]]")]
    Empty,
    #[error("platform: all limbs end on the platform; leave the key out")]
    PlatformOfLimbs,
    #[error("platform: name the body whose freedoms are to be analysed")]
    NoPlatform,
    #[error("platform: no joint names a body {0:?}")]
    UnknownPlatform(String),
    #[error("no joint names the body {GROUND:?}: connect a body to it")]
    NoGround,
    #[error("{0}: the two axes of a universal joint (U) must cross; for parallel ones use one R")]
    ParallelAxes(String),
    #[error("{0}: `pitch` must be finite; a joint that only slides is a P")]
    InfinitePitch(String),
    #[error(transparent)]
    Mechanism(#[from] MechanismError),
}

fn mechanism(file: &File) -> Result<Mechanism, DescriptionError> {
    match (file.limb.is_empty(), file.joint.is_empty()) {
        (false, true) => parallel(&file.limb, file.platform.as_deref()),
        (true, false) => graph(&file.joint, file.platform.as_deref()),
        (false, false) => Err(DescriptionError::LimbsAndJoints),
        (true, true) => Err(DescriptionError::Empty),
    }
}

fn parallel(limbs: &[LimbEntry], platform: Option<&str>) -> Result<Mechanism, DescriptionError> {
    if platform.is_some() {
        return Err(DescriptionError::PlatformOfLimbs);
    }
    let limbs = limbs
        .iter()
        .zip(1..)
        .map(|(limb, number)| {
            let joints = limb.joints.iter().zip(1..);
            joints
                .map(|(joint, at)| joint.joint(0, 0, || format!("limb {number}, joint {at}")))
                .collect()
        })
        .collect::<Result<_, _>>()?;
    Ok(Mechanism::Parallel(ParallelMechanism::new(limbs)?))
}

fn graph(entries: &[GraphEntry], platform: Option<&str>) -> Result<Mechanism, DescriptionError> {
    let platform = platform.ok_or(DescriptionError::NoPlatform)?;
    let mut bodies: std::collections::HashMap<&str, usize> = [(GROUND, 0)].into();
    for body in entries.iter().flat_map(|entry| &entry.between) {
        let next = bodies.len();
        bodies.entry(body).or_insert(next);
    }
    if !entries
        .iter()
        .any(|entry| entry.between.iter().any(|body| body == GROUND))
    {
        return Err(DescriptionError::NoGround);
    }
    let platform = *bodies
        .get(platform)
        .ok_or_else(|| DescriptionError::UnknownPlatform(platform.into()))?;
    let joints = entries
        .iter()
        .zip(1..)
        .map(|(entry, number)| {
            let [from, to] = entry.between.each_ref().map(|body| bodies[body.as_str()]);
            entry.joint.joint(from, to, || format!("joint {number}"))
        })
        .collect::<Result<_, _>>()?;
    let graph = MechanismGraph::new(bodies.len(), platform, joints)?;
    Ok(Mechanism::Graph(graph))
}

#[cfg(test)]
mod tests {
    use crate::mobility::parse;

    /// Why a limb with this joint is refused.
    fn refusal(joint: &str) -> String {
        let text = format!("name = \"one limb\"\n[[limb]]\njoints = [{joint}]\n");
        let refused = parse("limb.toml", &text);
        refused.err().expect("a refusal").to_string()
    }

    #[test]
    fn a_universal_joint_needs_axes_that_cross() {
        let axis2 = "point = [0, 0, 0], axis = [0, 0, 1], axis2";
        let message = refusal(&format!("{{ kind = \"U\", {axis2} = [0, 0, -3] }}"));
        assert!(
            message.contains("limb 1, joint 1: the two axes"),
            "{message}"
        );
    }

    #[test]
    fn an_infinite_pitch_is_told_from_a_bad_axis() {
        let screw = "{ kind = \"H\", point = [0, 0, 0], axis = [0, 0, 1], pitch = inf }";
        let message = refusal(screw);
        assert!(
            message.contains("limb 1, joint 1: `pitch` must be finite"),
            "{message}"
        );
    }
}
