//! Which keys of `[wiring]` an arm can have.

use crate::refusal::Key;
use crate::robot::Robot;
use crate::source::{FileError, Source};
use fivebar_plant::Wiring;

/// Refuses a mistake in a part that the arm does not have.
pub(super) fn check_for(
    wiring: &Wiring,
    robot: &Robot,
    source: &Source<'_>,
) -> Result<(), FileError> {
    let kind = robot.monitored_kind();
    let mut keys = wiring.keys().into_iter();
    let Some(key) = keys.find(|key| key.is_made && !key.kinds.contains(&kind)) else {
        return Ok(());
    };
    let of: Vec<_> = key.kinds.iter().map(|kind| kind.motors()).collect();
    let reason = format!(
        "is a mistake with {}, and this arm has {}: leave it out",
        of.join(" or "),
        kind.motors()
    );
    Err(source.refuse(Key::In("wiring", key.name), reason))
}
