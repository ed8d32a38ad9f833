//! Lengths, masses, inertias and the weight that they have.

use super::{Plausible, longest, reach};
use crate::refusal::Key;
use crate::robot::Robot;

/// Strongest gravity in the plane of an arm [m/s²]: Earth's and a half.
const GRAVITY: f64 = 15.0;

/// The shortest of the five lengths, as a share of the longest.
const LENGTH: f64 = 0.01;

/// Mass of a link over the cube of its length [kg/m³]: a rod of plastic a hundredth as thick as it is
/// long, and a cube of steel.
const MASS: [f64; 2] = [0.1, 8000.0];

/// Radius of gyration about the centre of mass, as a share of the length. A slender rod has 0.29.
const GYRATION: [f64; 2] = [0.02, 4.0];

/// Distance of a point of a link or of the tool, as a multiple of the longest link.
const POINT: f64 = 10.0;

/// The greatest payload as a multiple of the links' mass.
const PAYLOAD: f64 = 50.0;

/// The torque for the payload, as a multiple of the motors' peak torque. A payload a little too heavy is found
/// by the run, which says where the torque ends.
const LOAD: f64 = 20.0;

pub(super) fn rules(robot: &Robot) -> Vec<Plausible> {
    let mut rules = vec![Plausible::new(
        Key::Top("gravity"),
        (robot.gravity.norm(), "m/s²"),
        [0.0, GRAVITY],
        "Earth has 9.81",
    )];
    rules.extend(lengths(robot));
    if let Ok(arm) = robot.arm() {
        let lengths = robot.geometry.lengths();
        for (index, (link, length)) in arm.links().iter().zip(lengths).enumerate() {
            let key = |name| Key::Of("link", index, name);
            let volume = length.powi(3);
            let gyration = |share: f64| link.mass * (share * length).powi(2);
            rules.extend([
                Plausible::new(
                    key("mass"),
                    (link.mass, "kg"),
                    MASS.map(|density| density * volume),
                    "from a thin rod of plastic to a cube of steel of the link's `length`",
                ),
                Plausible::new(
                    key("com"),
                    (link.com.norm(), "m"),
                    [0.0, POINT * length],
                    "ten times the link's `length`",
                ),
                Plausible::new(
                    key("inertia"),
                    (link.inertia, "kg·m²"),
                    GYRATION.map(gyration),
                    "`mass` × (1/50 to 2 times `length`)²",
                ),
            ]);
        }
        rules.extend(payload(robot));
    }
    rules
}

fn lengths(robot: &Robot) -> impl Iterator<Item = Plausible> {
    let longest = longest(robot);
    let lengths = robot.geometry.lengths();
    let length = move |(index, length): (usize, f64)| {
        let key = match index {
            0..4 => Key::Of("link", index, "length"),
            _ => Key::Top("base"),
        };
        let length = Plausible::new(
            key,
            (length, "m"),
            [LENGTH * longest, longest],
            "a hundredth of the longest of the links and the base, to the longest",
        );
        // Without a base, the cranks are coaxial.
        if index == 4 { length.or_zero() } else { length }
    };
    let [along, left] = robot.tool.offset;
    let offset = Plausible::new(
        Key::In("tool", "offset"),
        (along.hypot(left), "m"),
        [0.0, POINT * longest],
        "ten times the longest link",
    );
    lengths.into_iter().enumerate().map(length).chain([offset])
}

/// The payload, which the motors must hold and accelerate.
fn payload(robot: &Robot) -> Option<Plausible> {
    let arm = robot.arm().ok()?;
    let drives = robot.drives().ok()?;
    let links: f64 = arm.links().iter().map(|link| link.mass).sum();
    let torque = drives.map(|drive| drive.peak_torque());
    let acceleration = robot.gravity.norm() + robot.motion.max_acceleration;
    let carried = LOAD * torque[0].max(torque[1]) / (reach(robot) * acceleration);
    let greatest = PAYLOAD * links;
    let mut payload = Plausible::new(
        Key::Top("payload"),
        (arm.payload(), "kg"),
        [0.0, greatest],
        "50 times the mass of the links",
    );
    // An ideal drive has torque for what it carries.
    if robot.actuators.is_some() && carried < greatest {
        payload.range = [0.0, carried];
        payload.reason = "what 20 times the motors' peak \
                          torque holds at the full reach, and accelerates by the `max_acceleration` \
                          of [motion]";
    }
    Some(payload)
}
