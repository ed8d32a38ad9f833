//! The analysis as JSON, one object per mechanism.

use super::MobilityAnalysis;
use fivebar_design::mobility::{Mobility, Pitch, ScrewAxis};
use serde_json::{Map, Value, json};

/// The analysis as one JSON object; lengths in the file's unit.
pub fn answer(name: &str, analysis: &MobilityAnalysis) -> Value {
    let mut object = Map::new();
    let mut put = |key: &str, value: Value| object.insert(key.into(), value);
    put("name", json!(name));
    match analysis {
        MobilityAnalysis::Parallel(analysis) => {
            put("p", json!(analysis.limbs.len()));
            put(
                "q",
                analysis
                    .limbs
                    .iter()
                    .map(|limb| limb.constraints.len())
                    .collect(),
            );
            put("rank_W", json!(analysis.wrench_rank));
            put("k", json!(analysis.k));
            put("zeta", json!(analysis.passive));
            put("platform_dof_eq9", json!(analysis.m_eq9));
            put(
                "constraints",
                json!({
                    "limbs": analysis.limbs.iter().map(|limb| wrenches(&limb.constraints)).collect::<Value>(),
                    "common": wrenches(&analysis.common),
                    "platform": wrenches(&analysis.platform_constraints),
                }),
            );
            put_mobility(&mut object, &analysis.mobility);
        }
        MobilityAnalysis::Graph(analysis) => {
            put("loops", json!(analysis.loops));
            put("rankJ", json!(analysis.jacobian_rank));
            put("platform_dof", json!(analysis.mobility.platform_dof));
            put(
                "constraints",
                json!({ "platform": wrenches(&analysis.platform_constraints) }),
            );
            put_mobility(&mut object, &analysis.mobility);
        }
    }
    Value::Object(object)
}

fn put_mobility(object: &mut Map<String, Value>, mobility: &Mobility) {
    let freedoms = mobility.freedoms.iter();
    let pairs = [
        ("n", json!(mobility.bodies)),
        ("g", json!(mobility.joints)),
        ("sum_f", json!(mobility.sum_f)),
        ("lambda", json!(mobility.lambda)),
        ("d", json!(mobility.order)),
        ("v", json!(mobility.redundant)),
        ("M_eq7", json!(mobility.m_eq7)),
        ("pure_translations", json!(mobility.pure_translations)),
        ("rot_rank", json!(mobility.rotations)),
        ("grubler6", json!(mobility.grubler)),
        ("M_inst", json!(mobility.instantaneous)),
        ("finite_M", json!(mobility.finite)),
        (
            "inst_exceeds_finite",
            json!(mobility.instantaneous > mobility.finite),
        ),
        (
            "freedoms",
            freedoms
                .map(|f| screw(f, ["rotation", "screw", "translation"]))
                .collect(),
        ),
    ];
    for (key, value) in pairs {
        object.insert(key.into(), value);
    }
    if let Some(held) = mobility.with_drives_held {
        object.insert("M_with_drives_held".into(), json!(held));
    }
}

fn wrenches(screws: &[ScrewAxis]) -> Value {
    let kinds = ["force", "wrench", "couple"];
    screws.iter().map(|s| screw(s, kinds)).collect()
}

/// A screw; `zero`, `finite` and `infinite` are the words for its kinds of pitch.
fn screw(screw: &ScrewAxis, [zero, finite, infinite]: [&str; 3]) -> Value {
    let axis = [screw.direction.x, screw.direction.y, screw.direction.z];
    let point = screw.point.map(|p| [p.x, p.y, p.z]);
    match screw.pitch {
        Pitch::Zero => json!({"kind": zero, "axis": axis, "point": point}),
        Pitch::Finite(pitch) => {
            json!({"kind": finite, "axis": axis, "point": point, "pitch": pitch})
        }
        Pitch::Infinite => json!({"kind": infinite, "axis": axis}),
    }
}
