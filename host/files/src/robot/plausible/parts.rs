//! Tolerances of the parts, material of the pins, drag of a crossing.

use super::{Plausible, reach, shortest};
use crate::refusal::Key;
use crate::robot::Robot;

/// Tolerances and clearances, as shares of the shortest length.
pub(super) const LENGTH: f64 = 0.05;
pub(super) const CLEARANCE: f64 = 0.01;

/// Error of a driven angle [rad]: two degrees.
const INPUT: f64 = 0.035;

/// Elastic modulus of pins and bearings [Pa]: soft plastic to diamond.
const MODULUS: [f64; 2] = [3e8, 1.3e12];

/// Poisson's ratio: cork has almost none.
const POISSON: [f64; 2] = [0.02, 0.5];

/// Radius of a bearing over the shortest length.
const BEARING: [f64; 2] = [1e-3, 0.5];

/// Coulomb's coefficient of friction.
const FRICTION: f64 = 3.0;

/// Drag at the tip over the force of the peak torque at the full reach.
const DRAG: f64 = 10.0;

pub(super) fn rules(robot: &Robot) -> Vec<Plausible> {
    let shortest = shortest(robot);
    let tolerance = &robot.tolerance;
    let contact = &robot.contact;
    let at_most = |name, values: &[f64], unit, most: f64, reason| {
        let key = Key::In("tolerance", name);
        let rule = |value: &f64| Plausible::new(key, (*value, unit), [0.0, most], reason);
        values.iter().map(rule).collect::<Vec<_>>()
    };
    let of_length = "1/20 of the shortest length";
    let of_angle = "two degrees";
    let mut rules = at_most(
        "length_sd",
        &tolerance.length_sd,
        "m",
        LENGTH * shortest,
        of_length,
    );
    rules.extend(at_most(
        "input_sd",
        &tolerance.input_sd,
        "rad",
        INPUT,
        of_angle,
    ));
    rules.extend(at_most(
        "input_max",
        &tolerance.input_max,
        "rad",
        INPUT,
        of_angle,
    ));
    rules.extend(at_most(
        "clearance_radius",
        &tolerance.clearance_radius,
        "m",
        CLEARANCE * shortest,
        "1/100 of the shortest length",
    ));
    rules.extend([
        Plausible::new(
            Key::In("contact", "elastic_modulus"),
            (contact.elastic_modulus, "Pa"),
            MODULUS,
            "from soft plastic to diamond",
        ),
        Plausible::new(
            Key::In("contact", "poisson_ratio"),
            (contact.poisson_ratio, ""),
            POISSON,
            "metals have 0.3",
        )
        .or_zero(),
        Plausible::new(
            Key::In("contact", "bearing_radius"),
            (contact.bearing_radius, "m"),
            BEARING.map(|share| share * shortest),
            "1/1000 to 1/2 of the shortest length",
        ),
        Plausible::new(
            Key::In("contact", "friction"),
            (contact.friction, ""),
            [0.0, FRICTION],
            "a coefficient of friction",
        ),
    ]);
    if let Ok(drives) = robot.drives() {
        let torque = drives.map(|drive| drive.peak_torque());
        let force = torque[0].max(torque[1]) / reach(robot);
        rules.push(Plausible::new(
            Key::In("crossing", "drag"),
            (robot.crossing.drag, "N"),
            [0.0, DRAG * force],
            "10 times the force of the motors' peak torque at the full reach",
        ));
    }
    rules
}
