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

impl JointEntry {
    fn joint(&self, from: usize, to: usize) -> Joint {
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
            } => (vec![line(axis, point), line(axis2, point)], *actuated),
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
        Joint {
            from,
            to,
            freedoms,
            actuated,
        }
    }
}

pub(super) fn parse(source: Source<'_>) -> Result<MobilityCase, FileError> {
    let file: File = source.parse()?;
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
        .map(|limb| limb.joints.iter().map(|joint| joint.joint(0, 0)).collect())
        .collect();
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
        .map(|entry| {
            let [from, to] = &entry.between;
            entry
                .joint
                .joint(bodies[from.as_str()], bodies[to.as_str()])
        })
        .collect();
    let graph = MechanismGraph::new(bodies.len(), platform, joints)?;
    Ok(Mechanism::Graph(graph))
}
