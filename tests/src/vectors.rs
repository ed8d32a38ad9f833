//! The reference states in `data/five_bar_vectors.json`, made by Lagrange's equations of the
//! first kind and checked against MuJoCo. SI units and radians.

use fivebar_kinematics::five_bar::Side;
use serde::Deserialize;

/// All of them.
#[derive(Debug, Deserialize)]
pub struct Vectors {
    /// The arms.
    pub robots: Vec<ReferenceArm>,
    /// The states.
    pub cases: Vec<Case>,
}

/// An arm.
#[derive(Clone, Debug, Deserialize)]
pub struct ReferenceArm {
    /// l1…l4 and the base [m].
    pub link_lengths: [f64; 5],
    /// Of links 1…4 [kg].
    pub mass: [f64; 4],
    /// Of links 1…4 [kg·m²].
    pub inertia_about_com: [f64; 4],
    /// Of links 1…4, along and to the left of the link [m].
    pub com: [[f64; 2]; 4],
    /// At C [kg].
    pub payload: f64,
    /// In the plane [m/s²].
    pub gravity: [f64; 2],
}

/// A state of an arm: the given values, and the results.
#[derive(Debug, Deserialize)]
#[expect(missing_docs, reason = "the letters of docs/design/notation.md")]
pub struct Case {
    /// The index of the arm.
    pub robot: usize,
    pub theta1: f64,
    pub theta4: f64,
    pub omega1: f64,
    pub omega4: f64,
    pub alpha1: f64,
    pub alpha4: f64,
    pub assembly: Side,
    pub elbow1: Side,
    pub elbow4: Side,
    pub external_force: [f64; 2],
    pub c: [f64; 2],
    pub c_velocity: [f64; 2],
    pub c_acceleration: [f64; 2],
    pub omega2: f64,
    pub omega3: f64,
    pub alpha2: f64,
    pub alpha3: f64,
    pub theta2: f64,
    pub theta3: f64,
    pub torque: [f64; 2],
    pub mass_matrix: [[f64; 2]; 2],
    pub bias_torque: [f64; 2],
    /// Forces in the joints A to E [N].
    pub reaction: Reaction,
}

/// Forces in the joints [N]: a ground on link 1, b link 1 on link 2, c link 2 on link 3,
/// d link 4 on link 3, e ground on link 4.
#[derive(Debug, Deserialize)]
#[expect(missing_docs, reason = "the joints' letters")]
pub struct Reaction {
    pub a: [f64; 2],
    pub b: [f64; 2],
    pub c: [f64; 2],
    pub d: [f64; 2],
    pub e: [f64; 2],
}

impl Vectors {
    /// Reads them.
    ///
    /// # Panics
    /// The file is not as described here.
    pub fn read() -> Self {
        let text = include_str!("../data/five_bar_vectors.json");
        serde_json::from_str(text).expect("reference vectors")
    }
}
