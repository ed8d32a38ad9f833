//! Standard and base parameters of an arm with known masses.

use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::dynamics::Arm;

/// Of links 1 to 4 each m, hx, hy, J; the payload belongs to link 2, the rotors to J1 and J4.
pub fn standard_parameters(arm: &Arm<f64>) -> [f64; 16] {
    let l2 = arm.geometry().l2();
    let payload = arm.payload();
    let [rotor1, rotor4] = arm.rotor_inertia();
    let more = [
        [0.0, 0.0, rotor1],
        [payload, payload * l2, payload * l2 * l2],
        [0.0; 3],
        [0.0, 0.0, rotor4],
    ];
    let mut standard = [0.0; 16];
    for (j, (link, [mass, moment, inertia])) in arm.links().iter().zip(more).enumerate() {
        let h = link.com * link.mass;
        standard[4 * j] = link.mass + mass;
        standard[4 * j + 1] = h.x + moment;
        standard[4 * j + 2] = h.y;
        standard[4 * j + 3] = link.inertia + link.mass * link.com.length_squared() + inertia;
    }
    standard
}

/// The base parameters in the order of [`BASE_NAMES`](super::BASE_NAMES). With K = h3x/l3, the
/// part of link 3 that acts as a mass at C:
///
/// J1* = J1 + l1² (m2 + K), J4* = J4 + l4² (m3 − K), J2* = J2 + l2² K, J3* = J3 − l3 h3x,
/// h2x* = h2x + l2 K, h2y, h3y, h1x* = h1x + l1 (m2 + K), h1y, h4x* = h4x + l4 (m3 − K), h4y.
///
/// They are no inertias: J3* may be negative.
pub fn base_parameters(lengths: [f64; 5], standard: &[f64; 16]) -> [f64; 11] {
    let [l1, l2, l3, l4, _] = lengths;
    let [
        _,
        h1x,
        h1y,
        j1,
        m2,
        h2x,
        h2y,
        j2,
        m3,
        h3x,
        h3y,
        j3,
        _,
        h4x,
        h4y,
        j4,
    ] = *standard;
    let k = h3x / l3;
    [
        j1 + l1 * l1 * (m2 + k),
        j4 + l4 * l4 * (m3 - k),
        j2 + l2 * l2 * k,
        j3 - l3 * h3x,
        h2x + l2 * k,
        h2y,
        h3y,
        h1x + l1 * (m2 + k),
        h1y,
        h4x + l4 * (m3 - k),
        h4y,
    ]
}
