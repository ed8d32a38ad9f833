//! How far pins and inputs can take the points of a linkage.

use fivebar_design::accuracy::linkage::ResultKind;
use fivebar_design::linkage::{Coordinate, Linkage, LinkageMotion};
use fivebar_kinematics::PlanarVector;
use nalgebra::DMatrix;
use nalgebra::Vector2;
use std::f64::consts::PI;

/// How far errors of any direction take a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Every pin where it does most, to first order [m].
    pub clearance_worst: f64,
    /// Root mean square for pins in uniformly random directions, to first order [m].
    pub clearance_rms: f64,
    /// Greatest displacement at a corner of the inputs' errors [m]; none where a corner
    /// cannot be assembled, and for more inputs than have their corners tried.
    pub input_worst: Option<f64>,
}

/// 2ⁿ corners are tried for up to so many inputs.
const MOST_INPUTS: usize = 8;
/// Directions in which the farthest place is sought: it is found to (π/1440)²/2.
const DIRECTIONS: u32 = 720;

/// J, how a point answers to a pin's offset c = r e^{ia}, turned by a: ∂x/∂r = J e^{ia} and
/// ∂x/∂a = r J i e^{ia} give its two columns.
struct Answer {
    radius: f64,
    columns: [Vector2<f64>; 2],
}

impl Answer {
    /// The farthest that the pin takes the point along d: r |Jᵀ d|.
    fn along(&self, d: Vector2<f64>) -> f64 {
        let [along, across] = self.columns;
        self.radius * along.dot(&d).hypot(across.dot(&d))
    }

    /// ⟨|J c|²⟩ = r²/2 |J|² for directions that are uniform.
    fn mean_square(&self) -> f64 {
        let [along, across] = self.columns;
        0.5 * self.radius * self.radius * (along.norm_squared() + across.norm_squared())
    }
}

/// The reach of each point. `pins` holds the radius of each pin and its column in `t`, the
/// angle's being the next; `corners` what [`input_worst`] found.
pub(super) fn reach(
    motion: &LinkageMotion<f64>,
    pins: &[(f64, usize)],
    corners: Option<&[f64]>,
    t: &DMatrix<f64>,
    results: &[ResultKind],
) -> Vec<Option<Reach>> {
    let mut reach = vec![None; motion.points.len()];
    for (row, result) in results.iter().enumerate() {
        let ResultKind::Position(point, 0) = *result else {
            continue;
        };
        let by = |column: usize| Vector2::new(t[(row, column)], t[(row + 1, column)]);
        let pins = pins.iter().filter(|(radius, _)| *radius > 0.0);
        let answers: Vec<Answer> = pins
            .map(|&(radius, column)| Answer {
                radius,
                columns: [by(column), by(column + 1) * (1.0 / radius)],
            })
            .collect();
        let far = |i: u32| -> f64 {
            let d = Vector2::unit(PI * f64::from(i) / f64::from(DIRECTIONS));
            answers.iter().map(|answer| answer.along(d)).sum()
        };
        let squares = answers.iter().map(Answer::mean_square);
        reach[point] = Some(Reach {
            clearance_worst: (0..DIRECTIONS).map(far).fold(0.0, f64::max),
            clearance_rms: squares.sum::<f64>().sqrt(),
            input_worst: corners.map(|corners| corners[point]),
        });
    }
    reach
}

/// The greatest displacement of each point at the corners of the inputs' errors [m].
pub(super) fn input_worst(
    linkage: &Linkage<f64>,
    inputs: &[Coordinate<f64>],
    greatest: &[f64],
    ideal: &LinkageMotion<f64>,
) -> Option<Vec<f64>> {
    if inputs.len() > MOST_INPUTS {
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
