//! Walls and guides from the numbers of Python.

use fivebar_firmware::motion::{FIXTURES, Fixture, FixtureShape, Impedance};

/// A wall or a guide: its kind, its numbers, stiffness [N/m] and damping [N·s/m].
pub(crate) type Told = (String, [f64; 6], f64, f64);

/// Springs [N/m] and dampers [N·s/m] as xx, xy, yy.
pub(crate) fn impedance(stiffness: [f64; 3], damping: [f64; 3]) -> Impedance {
    let single = |values: [f64; 3]| values.map(|value| value as f32).into();
    Impedance {
        stiffness: single(stiffness),
        damping: single(damping),
    }
}

/// Walls and guides.
///
/// # Errors
/// Too many, or one of an unknown kind.
pub(crate) fn fixtures(told: &[Told]) -> Result<[Option<Fixture>; FIXTURES], String> {
    if told.len() > FIXTURES {
        let given = told.len();
        return Err(format!(
            "an arm has at most {FIXTURES} walls and guides, not {given}"
        ));
    }
    let mut fixtures = [None; FIXTURES];
    for (slot, told) in fixtures.iter_mut().zip(told) {
        *slot = Some(fixture(told)?);
    }
    Ok(fixtures)
}

fn fixture((kind, numbers, stiffness, damping): &Told) -> Result<Fixture, String> {
    let [a, b, c, d, e, f] = numbers.map(|value| value as f32);
    let (point, normal, radius) = ((a, b), (c, d), c);
    let (centre, axis, half) = (point, normal, (e, f));
    let shape = match kind.as_str() {
        "half_plane" => FixtureShape::HalfPlane { point, normal },
        "box" => FixtureShape::Box { centre, axis, half },
        "inside" => FixtureShape::Inside { centre, radius },
        "outside" => FixtureShape::Outside { centre, radius },
        "line" => FixtureShape::Line { point, normal },
        "circle" => FixtureShape::Circle { centre, radius },
        _ => return Err(format!("there is no wall or guide {kind}")),
    };
    Ok(Fixture {
        shape,
        stiffness: *stiffness as f32,
        damping: *damping as f32,
    })
}
