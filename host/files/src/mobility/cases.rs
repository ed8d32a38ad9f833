//! Mechanisms as lists of cases in JSON: twists of six numbers, in limbs or in a graph.

use super::{Mechanism, MobilityCase};
use fivebar_design::mobility::{
    Freedom, Joint, MechanismError, MechanismGraph, ParallelMechanism, Screw,
};
use nalgebra::Vector6;
use serde::Deserialize;
use serde::de::IgnoredAny;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Cases {
    // What the twists mean, in words, and below the source and the results of reference cases. They are not used.
    #[serde(rename = "convention")]
    _convention: Option<IgnoredAny>,
    #[serde(default)]
    parallel: Vec<ParallelCase>,
    #[serde(default)]
    graph: Vec<GraphCase>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ParallelCase {
    #[serde(rename = "source")]
    _source: Option<IgnoredAny>,
    #[serde(rename = "expected")]
    _expected: Option<IgnoredAny>,
    name: String,
    #[serde(default)]
    description: String,
    limbs: Vec<Vec<[f64; 6]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GraphCase {
    #[serde(rename = "source")]
    _source: Option<IgnoredAny>,
    #[serde(rename = "expected")]
    _expected: Option<IgnoredAny>,
    name: String,
    #[serde(default)]
    description: String,
    bodies: usize,
    platform_body: usize,
    joints: Vec<GraphJoint>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GraphJoint {
    a: usize,
    b: usize,
    twists: Vec<[f64; 6]>,
}

/// Why a list of cases is not valid.
#[derive(Debug, thiserror::Error)]
pub(super) enum CasesError {
    /// The text is not JSON, or has other keys.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// There is no case.
    #[error("no case: expected a list under \"parallel\" or \"graph\"")]
    Empty,
    /// The case with this name is not a mechanism.
    #[error("case {0:?}: {1}")]
    Case(String, MechanismError),
}

pub(super) fn parse(text: &str) -> Result<Vec<MobilityCase>, CasesError> {
    let cases = read(text)?;
    if cases.parallel.is_empty() && cases.graph.is_empty() {
        return Err(CasesError::Empty);
    }
    let parallel = cases.parallel.into_iter().map(|case| {
        let limbs = case
            .limbs
            .iter()
            .map(|limb| limb.iter().map(|t| joint(0, 0, &[*t])).collect());
        let mechanism = ParallelMechanism::new(limbs.collect())
            .map_err(|error| CasesError::Case(case.name.clone(), error))?;
        Ok(MobilityCase {
            name: case.name,
            description: case.description,
            mechanism: Mechanism::Parallel(mechanism),
        })
    });
    let graph = cases.graph.into_iter().map(|case| {
        let joints = case
            .joints
            .iter()
            .map(|j| joint(j.a, j.b, &j.twists))
            .collect();
        let mechanism = MechanismGraph::new(case.bodies, case.platform_body, joints)
            .map_err(|error| CasesError::Case(case.name.clone(), error))?;
        Ok(MobilityCase {
            name: case.name,
            description: case.description,
            mechanism: Mechanism::Graph(mechanism),
        })
    });
    parallel.chain(graph).collect()
}

/// Reads a file with lists of cases, or with a single case.
fn read(text: &str) -> Result<Cases, serde_json::Error> {
    let value: serde_json::Value = serde_json::from_str(text)?;
    let alone = |key| value.get(key).is_some_and(serde_json::Value::is_array);
    let wrapped = if alone("limbs") {
        serde_json::json!({ "parallel": [value] })
    } else if alone("joints") {
        serde_json::json!({ "graph": [value] })
    } else {
        value
    };
    serde_json::from_value(wrapped)
}

fn joint(from: usize, to: usize, twists: &[[f64; 6]]) -> Joint {
    let freedom =
        |twist: &[f64; 6]| Freedom::Screw(Screw::from_vector(&Vector6::from_row_slice(twist)));
    Joint {
        from,
        to,
        freedoms: twists.iter().map(freedom).collect(),
        actuated: false,
    }
}
