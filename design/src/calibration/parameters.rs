//! The unknowns of a calibration.

use core::f64::consts::TAU;
use nalgebra::SVector;

/// The unknowns as a vector, in the order l1…l5, δ1, δ4, x, y, φ.
pub(super) type Vector10 = SVector<f64, 10>;

/// Their names, in the order of the Jacobian's columns.
pub const PARAMETER_NAMES: [&str; 10] = ["l1", "l2", "l3", "l4", "l5", "δ1", "δ4", "x", "y", "φ"];

/// Their typical sizes: 0.1 m and 1 rad. Rank and condition are of columns multiplied by these.
pub(super) const SCALES: [f64; 10] = [0.1, 0.1, 0.1, 0.1, 0.1, 1.0, 1.0, 0.1, 0.1, 1.0];

/// Lengths, joint offsets and placement of an arm over a plate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parameters {
    /// l1…l4 and the base l5 [m].
    pub lengths: [f64; 5],
    /// δ1, δ4: joint angle less encoder angle [rad].
    pub offsets: [f64; 2],
    /// x, y of A on the plate [m].
    pub origin: [f64; 2],
    /// φ, the direction of the base on the plate [rad].
    pub turn: f64,
}

impl Parameters {
    pub(super) fn vector(&self) -> Vector10 {
        let [l1, l2, l3, l4, l5] = self.lengths;
        let ([d1, d4], [x, y]) = (self.offsets, self.origin);
        Vector10::from_column_slice(&[l1, l2, l3, l4, l5, d1, d4, x, y, self.turn])
    }

    /// From a vector; angles are brought into (−π, π].
    pub(super) fn of(vector: &Vector10) -> Self {
        let [l1, l2, l3, l4, l5, d1, d4, x, y, turn] = vector.data.0[0];
        Self {
            lengths: [l1, l2, l3, l4, l5],
            offsets: [d1, d4].map(within_a_turn),
            origin: [x, y],
            turn: within_a_turn(turn),
        }
    }
}

/// The same angle in (−π, π].
pub(super) fn within_a_turn(angle: f64) -> f64 {
    let turned = angle - TAU * (angle / TAU).round();
    if turned <= -0.5 * TAU {
        turned + TAU
    } else {
        turned
    }
}
