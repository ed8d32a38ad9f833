//! Worst errors of the points of a linkage by pins and inputs.

use super::ResultKind;
use crate::linkage::{Coordinate, Linkage, LinkageMotion};
use core::f64::consts::PI;
use fivebar_kinematics::PlanarVector;
use nalgebra::{DMatrix, Vector2};

/// Worst errors of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointError {
    /// Greatest displacement over all positions of the pins, to first order [m].
    pub clearance_worst: f64,
    /// Root mean square of the displacement for pins in uniformly random directions, to first
    /// order [m].
    pub clearance_rms: f64,
    /// Greatest displacement over all sign combinations of the greatest input errors [m]; none
    /// if one of them cannot be assembled, or if there are too many inputs.
    pub input_worst: Option<f64>,
}

/// Most inputs for which all 2ⁿ sign combinations are tried.
const MAX_INPUTS: usize = 8;
/// Directions in which the greatest displacement is searched. Its relative error is at most
/// (π/1440)²/2.
const DIRECTIONS: u32 = 720;

/// The Jacobian J of a point for a pin's offset c = r e^{ia}, rotated by a: its two columns
/// follow from ∂x/∂r = J e^{ia} and ∂x/∂a = r J i e^{ia}.
struct PinSensitivity {
    radius: f64,
    columns: [Vector2<f64>; 2],
}

impl PinSensitivity {
    /// The greatest displacement of the point along d by the pin: r |Jᵀ d|.
    fn along(&self, d: Vector2<f64>) -> f64 {
        let [along, across] = self.columns;
        self.radius * along.dot(&d).hypot(across.dot(&d))
    }

    /// ⟨|J c|²⟩ = r²/2 |J|² for uniformly random directions.
    fn mean_square(&self) -> f64 {
        let [along, across] = self.columns;
        0.5 * self.radius * self.radius * (along.norm_squared() + across.norm_squared())
    }
}

/// The clearance of a pin as a primitive.
#[derive(Clone, Copy)]
pub(super) struct PinRadius {
    /// r [m].
    pub(super) radius: f64,
    /// The radius's column among the primitives; the next one is the angle's.
    pub(super) column: usize,
}

/// The worst errors of each point. `pins` have their columns in `t`; `corners` is the result of
/// [`input_worst`].
pub(super) fn point_errors(
    motion: &LinkageMotion<f64>,
    pins: &[PinRadius],
    corners: Option<&[f64]>,
    t: &DMatrix<f64>,
    results: &[ResultKind],
) -> Vec<Option<PointError>> {
    let mut point_errors = vec![None; motion.points.len()];
    for (row, result) in results.iter().enumerate() {
        let ResultKind::Position(point, 0) = *result else {
            continue;
        };
        let by = |column: usize| Vector2::new(t[(row, column)], t[(row + 1, column)]);
        let pins = pins.iter().filter(|pin| pin.radius > 0.0);
        let answers: Vec<PinSensitivity> = pins
            .map(|&PinRadius { radius, column }| PinSensitivity {
                radius,
                columns: [by(column), by(column + 1) * (1.0 / radius)],
            })
            .collect();
        let far = |i: u32| -> f64 {
            let d = Vector2::unit(PI * f64::from(i) / f64::from(DIRECTIONS));
            answers.iter().map(|answer| answer.along(d)).sum()
        };
        let squares = answers.iter().map(PinSensitivity::mean_square);
        point_errors[point] = Some(PointError {
            // Not `f64::max`: of 0 and −0, which is the sum of no clearances, it may be either.
            clearance_worst: (0..DIRECTIONS)
                .map(far)
                .fold(0.0, |worst, far| if far > worst { far } else { worst }),
            clearance_rms: squares.sum::<f64>().sqrt(),
            input_worst: corners.map(|corners| corners[point]),
        });
    }
    point_errors
}

/// The greatest displacement of each point over all sign combinations of the greatest input
/// errors [m].
pub(super) fn input_worst(
    linkage: &Linkage<f64>,
    inputs: &[Coordinate<f64>],
    greatest: &[f64],
    ideal: &LinkageMotion<f64>,
) -> Option<Vec<f64>> {
    if inputs.len() > MAX_INPUTS {
        return None;
    }
    let mut worst = vec![0.0_f64; ideal.points.len()];
    for corner in 0..1_usize << inputs.len() {
        let mut displaced = inputs.to_vec();
        for (i, (input, greatest)) in displaced.iter_mut().zip(greatest).enumerate() {
            let sign = if corner >> i & 1 == 1 { 1.0 } else { -1.0 };
            input.value += sign * greatest;
        }
        let displaced = linkage.motion(&displaced).ok()?;
        let points = ideal.points.iter().zip(&displaced.points);
        for (worst, (ideal, displaced)) in worst.iter_mut().zip(points) {
            *worst = worst.max((displaced.position - ideal.position).norm());
        }
    }
    Some(worst)
}
