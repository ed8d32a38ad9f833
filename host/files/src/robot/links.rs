//! `[[link]]`: lengths, and masses of every link or of none.

use super::value::{
    LEAST_INERTIA, LEAST_MASS, LONGEST, NOT_NEGATIVE, POSITIVE, SHORTEST, at_least, near,
};
use crate::refusal::{Key, Refusal, Refusals};
use fivebar_kinematics::dynamics::Link;
use fivebar_kinematics::five_bar::{Geometry, GeometryError};
use nalgebra::Vector2;
use serde::Deserialize;

/// `[[link]]`: the last three keys are given together for every link, or for none.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LinkFile {
    length: f64,
    mass: Option<f64>,
    com: Option<[f64; 2]>,
    inertia: Option<f64>,
}

/// The geometry of the links and their base, and the links' masses, if they have any.
pub(super) type Links = (Geometry<f64>, Option<[Link<f64>; 4]>);

/// The four links on this base [m].
pub(super) fn read_links(
    given: &[LinkFile],
    base: f64,
    refusals: &mut Refusals,
) -> Result<Links, Refusal> {
    let links = refusals.noted(four_links(given))?;
    let geometry = refusals.noted(geometry(links, base));
    let inertias = inertias(links, refusals)?;
    Ok((geometry?, inertias))
}

fn four_links(given: &[LinkFile]) -> Result<&[LinkFile; 4], Refusal> {
    given.try_into().map_err(|_| {
        let count = given.len();
        let reason = format!("must be given four times, not {count}: links 1 to 4");
        Key::Top("link").refused(reason)
    })
}

fn geometry(links: &[LinkFile; 4], base: f64) -> Result<Geometry<f64>, Refusal> {
    let [l1, l2, l3, l4] = [0, 1, 2, 3].map(|i| links[i].length);
    let link = |index: usize| (Key::Of("link", index, "length"), links[index].length);
    for (key, length) in [(Key::Top("base"), base), link(0), link(1), link(2), link(3)] {
        if length > LONGEST && length.is_finite() {
            let reason = format!("is in metres, {LONGEST:?} at most, not {length:?}");
            return Err(key.refused(reason));
        }
        if length > 0.0 && length < SHORTEST {
            let reason = format!("is in metres, {SHORTEST:?} at least, not {length:?}");
            return Err(key.refused(reason));
        }
    }
    Geometry::new([l1, l2, l3, l4, base]).map_err(|error| match error {
        GeometryError::NotPositive(index @ 0..4) => Key::Of("link", index, "length").refused(
            format!("{POSITIVE} of metres, not {:?}", links[index].length),
        ),
        GeometryError::NotPositive(_) => {
            Key::Top("base").refused(format!("{NOT_NEGATIVE}, in metres, not {base:?}"))
        }
        GeometryError::ToolOffset => Key::In("tool", "offset").refused(error),
        GeometryError::CannotAssemble => Key::Top("base").refused(format!(
            "and the links cannot be assembled: of {l1:?}, {l2:?}, {l3:?}, {l4:?} and {base:?} m \
                 the longest exceeds the sum of the others"
        )),
        _ => Key::Top("base").refused(error),
    })
}

/// The links' masses, centres of mass and inertias: of every link, or of none (a robot with
/// lengths only).
fn inertias(
    links: &[LinkFile; 4],
    refusals: &mut Refusals,
) -> Result<Option<[Link<f64>; 4]>, Refusal> {
    let bare = |link: &LinkFile| (link.mass, link.com, link.inertia) == (None, None, None);
    if links.iter().all(bare) {
        return Ok(None);
    }
    let mut inertias = [Link {
        mass: 0.0,
        com: Vector2::zeros(),
        inertia: 0.0,
    }; 4];
    for (index, (link, inertia)) in links.iter().zip(&mut inertias).enumerate() {
        let key = |name| Key::Of("link", index, name);
        let missing = |name| {
            key(name).refused(
                "is missing: every link needs mass, com and inertia; for kinematics only, leave \
                 them out of all four",
            )
        };
        let mass = refusals.noted(link.mass.ok_or_else(|| missing("mass")))?;
        let com = refusals.noted(link.com.ok_or_else(|| missing("com")))?;
        let moment = refusals.noted(link.inertia.ok_or_else(|| missing("inertia")))?;
        refusals.note(at_least(key("mass"), mass, LEAST_MASS));
        refusals.note(near(key("com"), com));
        refusals.note(at_least(key("inertia"), moment, LEAST_INERTIA));
        *inertia = Link {
            mass,
            com: Vector2::from(com),
            inertia: moment,
        };
    }
    Ok(Some(inertias))
}
