//! What the tip carries, and the motors and gears to choose from: each motor by itself and with each gear, the cheapest first.

use crate::refusal::{Key, Refusal};
use fivebar_design::synthesis::{Drive, Payload};
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PayloadFile {
    mass: f64,
    speed: f64,
    acceleration: f64,
    #[serde(default)]
    gravity: [f64; 2],
    link_density: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MotorFile {
    name: String,
    torque: f64,
    speed: f64,
    inertia: f64,
    price: f64,
    mass: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GearFile {
    name: String,
    ratio: f64,
    efficiency: f64,
    torque: f64,
    price: f64,
    mass: f64,
}

/// The payload with its drives; none if the file has none.
pub(super) fn made(
    payload: Option<&PayloadFile>,
    motors: &[MotorFile],
    gears: &[GearFile],
) -> Result<Option<Payload>, Refusal> {
    let Some(payload) = payload else {
        return match (motors, gears) {
            ([], []) => Ok(None),
            _ => {
                let reason = "is missing, in kg: motors and gears are chosen for what the tip carries; give [payload]";
                Err(Key::In("payload", "mass").refused(reason))
            }
        };
    };
    let numbers = [
        ("mass", payload.mass, 0.0, 1e3, "kg"),
        ("speed", payload.speed, 0.0, 1e2, "m/s"),
        ("acceleration", payload.acceleration, 0.0, 1e4, "m/s²"),
        ("link_density", payload.link_density, 0.0, 1e2, "kg/m"),
        ("gravity", payload.gravity[0], -1e2, 1e2, "m/s²"),
        ("gravity", payload.gravity[1], -1e2, 1e2, "m/s²"),
    ];
    for (key, value, low, high, unit) in numbers {
        within(Key::In("payload", key), value, low, high, unit)?;
    }
    if motors.is_empty() {
        let reason = "needs [[motor]]: give one or more, each with `name`, `torque`, `speed`, `inertia`, `price` and `mass`";
        return Err(Key::In("payload", "mass").refused(reason));
    }
    for (index, motor) in motors.iter().enumerate() {
        let key = |key| Key::Of("motor", index, key);
        within(key("torque"), motor.torque, 1e-6, 1e4, "N·m")?;
        within(key("speed"), motor.speed, 1e-3, 1e5, "rad/s")?;
        within(key("inertia"), motor.inertia, 0.0, 1e2, "kg·m²")?;
        within(key("price"), motor.price, 0.0, 1e6, "of any currency")?;
        within(key("mass"), motor.mass, 0.0, 1e3, "kg")?;
    }
    for (index, gear) in gears.iter().enumerate() {
        let key = |key| Key::Of("gear", index, key);
        within(key("ratio"), gear.ratio, 0.01, 1e4, "turns of the motor")?;
        within(
            key("efficiency"),
            gear.efficiency,
            0.01,
            1.0,
            "of the power",
        )?;
        within(key("torque"), gear.torque, 1e-6, 1e5, "N·m")?;
        within(key("price"), gear.price, 0.0, 1e6, "of any currency")?;
        within(key("mass"), gear.mass, 0.0, 1e3, "kg")?;
    }
    let mut drives: Vec<Drive> = Vec::new();
    for motor in motors {
        drives.push(alone(motor));
        drives.extend(gears.iter().map(|gear| geared(motor, gear)));
    }
    drives.sort_by(|a, b| a.price.total_cmp(&b.price));
    Ok(Some(Payload {
        mass: payload.mass,
        speed: payload.speed,
        acceleration: payload.acceleration,
        gravity: payload.gravity,
        link_density: payload.link_density,
        drives,
    }))
}

fn within(key: Key, value: f64, low: f64, high: f64, unit: &str) -> Result<(), Refusal> {
    match (low..=high).contains(&value) {
        true => Ok(()),
        false => Err(key.refused(format!("must be {low:?} to {high:?} {unit}, not {value:?}"))),
    }
}

fn alone(motor: &MotorFile) -> Drive {
    Drive {
        name: motor.name.clone(),
        torque: motor.torque,
        speed: motor.speed,
        torque_limit: f64::INFINITY,
        inertia: motor.inertia,
        price: motor.price,
        mass: motor.mass,
    }
}

/// A gear divides the speed; it multiplies the torque, less its loss, and the rotor's inertia by the ratio's square.
fn geared(motor: &MotorFile, gear: &GearFile) -> Drive {
    Drive {
        name: format!("{} with {}", motor.name, gear.name),
        torque: motor.torque * gear.ratio * gear.efficiency,
        speed: motor.speed / gear.ratio,
        torque_limit: gear.torque,
        inertia: motor.inertia * gear.ratio * gear.ratio,
        price: motor.price + gear.price,
        mass: motor.mass + gear.mass,
    }
}
