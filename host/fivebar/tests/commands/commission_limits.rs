//! What a commissioning may do to an arm at most, checked on the simulated arm's own energies and
//! angles: neither its wiring nor its mismatch changes them. docs/use/bring-up.md states these limits.

use serde_json::Value;
use std::fs;
use std::path::Path;

/// What a motor of the benchtop arm does at its joint at the continuous current [N·m].
const CONTINUOUS_TORQUE: f64 = 8.0 * 0.0234 * 1.3;
/// Heat of both windings at the continuous currents [W].
const CONTINUOUS_HEAT: f64 = 2.0 * 2.3 * 1.3 * 1.3;
/// The benchtop arm's limits of the angles of joints 1 and 4 [rad].
const ANGLES: [[f64; 2]; 2] = [[0.6, 3.6], [-0.46, 2.54]];
/// Its greatest joint speed [rad/s].
const MAX_SPEED: f64 = 35.0;

/// A step's limits: kinetic energy [J], travel while the bridges are on [rad]. Before homing, energy
/// is what the continuous current does along the travel at which an excitation ends.
const LIMITS: [(&str, f64, f64); 7] = [
    ("motors", 0.1 * CONTINUOUS_TORQUE, 0.25),
    ("electrics", 0.45 * CONTINUOUS_TORQUE, 1.1),
    ("homing", 0.01, 3.1),
    ("friction", 0.1, 3.0),
    ("dynamics", 1.0, 3.0),
    ("belts", 0.45 * CONTINUOUS_TORQUE, 3.0),
    ("validation", 0.1, 3.0),
];
/// In this step the arm is homed, then moved by hand.
const BY_HAND: (&str, f64, f64) = ("geometry", 0.01, 3.1);

/// Steps before the first in which the arm is homed.
const UNHOMED: [&str; 2] = ["motors", "electrics"];

/// Asserts that no step that this folder reports of exceeded its limits. Returns the greatest shares
/// of the limits of energy, heat, travel and speed.
pub(crate) fn assert_within_limits(folder: &Path, lines: &str) -> [f64; 4] {
    let path = folder.join("out/simulated.json");
    let text = fs::read_to_string(&path).unwrap_or_else(|_| panic!("no simulated.json: {lines}"));
    let steps: Value = serde_json::from_str(&text).unwrap();
    let mut shares = [0.0_f64; 4];
    for step in steps.as_array().unwrap() {
        let of = |share: [f64; 4]| {
            assert!(
                share.iter().all(|share| *share <= 1.0),
                "{share:?} of the limits of energy, heat, travel and speed: {step} of {lines}"
            );
            share
        };
        for (most, share) in shares.iter_mut().zip(of(used(step))) {
            *most = most.max(share);
        }
    }
    shares
}

/// The shares of a step's limits that it used.
fn used(step: &Value) -> [f64; 4] {
    let name = step["step"].as_str().unwrap();
    let number = |key: &str| step[key].as_f64().unwrap();
    let greater = |key: &str| {
        f64::max(
            step[key][0].as_f64().unwrap(),
            step[key][1].as_f64().unwrap(),
        )
    };
    let powered = number("powered_s");
    let Some((_, energy, travel)) = LIMITS
        .iter()
        .chain([&BY_HAND])
        .find(|limit| limit.0 == name)
    else {
        assert_eq!(powered, 0.0, "the bridges are off: {step}");
        return [0.0; 4];
    };
    if !UNHOMED.contains(&name) && powered > 0.0 {
        for (angle, [least, greatest]) in step["angle_rad"].as_array().unwrap().iter().zip(ANGLES) {
            let [from, to] = [0, 1].map(|end| angle[end].as_f64().unwrap());
            assert!(
                from >= least && to <= greatest,
                "limits of the angles: {step}"
            );
        }
    }
    let heat = if powered > 0.0 {
        number("heat_j") / (CONTINUOUS_HEAT * powered)
    } else {
        0.0
    };
    [
        number("kinetic_energy_j") / energy,
        heat,
        greater("travel_rad") / travel,
        greater("speed_rad_s") / MAX_SPEED,
    ]
}
