//! A synthesis as JSON, and its designs as robot files.

use fivebar_design::synthesis::{Design, Drive, Found, Proof, Study, Synthesis};
use fivebar_files::robot::{Draft, DraftError, Motors};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// One JSON object. `unproved_at` is where the proof of the best design ended, else `null`.
pub fn answer(synthesis: &Synthesis) -> Value {
    let unproved_at = match synthesis.proof {
        Proof::Proved => None,
        Proof::Refuted(place) | Proof::Undecided(place) => Some(place),
    };
    json!({
        "best": design(&synthesis.best),
        "whole_millimetres": design(&synthesis.stock),
        "front": synthesis.front.iter().map(design).collect::<Vec<_>>(),
        "sensitivity_per_m": synthesis.sensitivity,
        "drive": synthesis.drives[0].as_ref().map(drive),
        "stock_drive": synthesis.drives[1].as_ref().map(drive),
        "evaluations": synthesis.evaluations,
        "proved": synthesis.proof == Proof::Proved,
        "unproved_at": unproved_at,
        "whole_proved": synthesis.stock_proof == Proof::Proved,
    })
}

fn drive(drive: &Drive) -> Value {
    json!({ "name": drive.name, "price": drive.price, "mass": drive.mass })
}

fn design(design: &Design) -> Value {
    let (measures, worst) = (design.measures, design.worst_points);
    let load = design.load;
    let load =
        json!({ "torque": load.torque, "speed": load.speed, "acceleration": load.acceleration });
    let has_error = measures.error > 0.0;
    json!({
        "link_lengths": design.lengths,
        "size": design.size,
        "link_sum": design.link_sum(),
        "dexterity": design.dexterity,
        "place": design.place,
        "torque_per_force": measures.torque,
        "speed_per_rate": measures.speed,
        "stiffness_per_drive": measures.stiffness,
        "error": has_error.then_some(measures.error),
        "load": (design.load.torque > 0.0).then_some(load),
        "worst_points": {
            "dexterity": worst.dexterity,
            "torque": worst.torque,
            "speed": worst.speed,
            "stiffness": worst.stiffness,
            "error": has_error.then_some(worst.error),
        },
    })
}

/// A robot file with the design's lengths, and masses and motors as `fivebar new` has them; with ideal
/// torque sources where those motors do not suit its size.
///
/// # Errors
/// The controller can't take such an arm.
pub fn robot_file(name: &str, design: &Design) -> Result<String, DraftError> {
    let [l1, l2, l3, l4, base] = design.lengths;
    let mut draft = Draft::new(name);
    draft.set_base(base);
    draft.set_cranks([l1, l4]);
    draft.set_couplers([l2, l3]);
    if draft.check().is_err() {
        draft.motors = Motors::Ideal;
        draft.check()?;
    }
    Ok(draft.text())
}

/// The name of the file of a study's searches.
pub const SEARCHES: &str = "searches.json";

/// The searches of a study that are done, as a file has them.
#[derive(Serialize, Deserialize)]
struct Searches {
    study: String,
    found: Vec<Option<Found>>,
}

/// The file of the searches that are done.
///
/// # Errors
/// None that a study has: the numbers are finite.
pub fn searches_text(study: &Study, found: &[Option<Found>]) -> Result<String, serde_json::Error> {
    serde_json::to_string(&Searches {
        study: identity(study),
        found: found.to_vec(),
    })
}

/// The searches of such a file; none if it is of another study or of another version of the search.
pub fn known_searches(study: &Study, text: &str) -> Option<Vec<Option<Found>>> {
    let searches: Searches = serde_json::from_str(text).ok()?;
    let is_same = searches.study == identity(study) && searches.found.len() == study.searches();
    is_same.then_some(searches.found)
}

fn identity(study: &Study) -> String {
    format!("{} {study:?}", env!("CARGO_PKG_VERSION"))
}
