//! A synthesis as JSON, and its designs as robot files.

use fivebar_design::synthesis::{Design, Proof, Synthesis};
use fivebar_files::robot::{Draft, DraftError, Motors};
use serde_json::{Value, json};

/// One JSON object. `unproved_at` is where the proof of the best design ended, else `null`.
pub fn answer(synthesis: &Synthesis) -> Value {
    let unproved_at = match synthesis.proof {
        Proof::Proved => None,
        Proof::Refuted(place) | Proof::Undecided(place) => Some(place),
    };
    json!({
        "best": design(&synthesis.best),
        "whole_millimetres": design(&synthesis.whole),
        "front": synthesis.front.iter().map(design).collect::<Vec<_>>(),
        "sensitivity_per_m": synthesis.sensitivity,
        "evaluations": synthesis.evaluations,
        "proved": synthesis.proof == Proof::Proved,
        "unproved_at": unproved_at,
        "whole_proved": synthesis.whole_proof == Proof::Proved,
    })
}

fn design(design: &Design) -> Value {
    json!({
        "link_lengths": design.lengths,
        "size": design.size,
        "link_sum": design.link_sum(),
        "dexterity": design.dexterity,
        "place": design.place,
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
