//! Errors of the encoders as further unknowns of the touched holes: two harmonics of each shaft.
//!
//! The shaft shows φ + Σ s_h sin hφ + c_h cos hφ at φ = n θ, so the joint is at the measured angle
//! less that sum over n. Its derivatives are those of the joint's offset times −sin hφ/n and
//! −cos hφ/n.

use super::fit::least_squares;
use fivebar_design::calibration::{Parameters, Touch, tip};
use fivebar_kinematics::five_bar::{Joint, Side};
use nalgebra::SMatrix;

/// Harmonics of each shaft.
const HARMONICS: usize = 2;
/// Lengths, offsets and placement; sine and cosine of each harmonic of both shafts.
const UNKNOWNS: usize = 10 + 4 * HARMONICS;
const ROUNDS: usize = 12;

/// The best arm with errors of its encoders.
pub(super) struct WithErrors {
    /// Lengths, offsets and placement.
    pub(super) parameters: Parameters,
    /// s and c of each harmonic of each joint's shaft [rad].
    pub(super) terms: [[[f64; 2]; HARMONICS]; 2],
    /// Root mean square of the residuals [m].
    pub(super) residual: f64,
}

impl WithErrors {
    /// The error of a joint's shaft over its ratio [rad], with the joint at `theta`.
    pub(super) fn at(&self, joint: Joint, theta: f64, ratio: f64) -> f64 {
        error(&self.terms[joint], theta, ratio)
    }

    /// Amplitude and phase of each harmonic of a joint's shaft, as a robot file has them.
    pub(super) fn text(&self, joint: Joint) -> String {
        let terms: Vec<String> = (1..)
            .zip(self.terms[joint])
            .map(|(harmonic, [s, c]): (u32, [f64; 2])| {
                let (amplitude, phase) = (s.hypot(c), c.atan2(s));
                format!(
                    "{{ harmonic = {harmonic}, amplitude = {amplitude:.6e}, phase = {phase:.6} }}"
                )
            })
            .collect();
        format!("[{}]", terms.join(", "))
    }
}

fn error(terms: &[[f64; 2]; HARMONICS], theta: f64, ratio: f64) -> f64 {
    let sum = (1..).zip(terms).map(|(harmonic, [s, c])| {
        let (sin, cos) = (f64::from(harmonic) * ratio * theta).sin_cos();
        s * sin + c * cos
    });
    sum.sum::<f64>() / ratio
}

/// Fits both, from the arm without errors on; none if the holes do not determine them.
pub(super) fn fit(
    start: &Parameters,
    touches: &[Touch],
    ratios: [f64; 2],
    assembly: Side,
) -> Option<WithErrors> {
    let mut found = WithErrors {
        parameters: *start,
        terms: [[[0.0; 2]; HARMONICS]; 2],
        residual: f64::INFINITY,
    };
    for _ in 0..ROUNDS {
        let (mut equations, mut residuals) = (Vec::new(), Vec::new());
        for touch in touches {
            let p = &found.parameters;
            let theta = Joint::ALL.map(|joint| touch.encoder[joint] + p.offsets[joint]);
            let encoder = Joint::ALL.map(|joint| {
                touch.encoder[joint] - error(&found.terms[joint], theta[joint], ratios[joint])
            });
            let tip = tip(p, encoder, assembly)?;
            let mut rows = SMatrix::<f64, 2, UNKNOWNS>::zeros();
            rows.fixed_columns_mut::<10>(0).copy_from(&tip.jacobian);
            for joint in Joint::ALL {
                for harmonic in 0..HARMONICS {
                    let phase = (harmonic + 1) as f64 * ratios[joint] * theta[joint];
                    let (sin, cos) = phase.sin_cos();
                    let by_offset = tip.jacobian.column(5 + joint.index());
                    let place = 10 + 2 * (HARMONICS * joint.index() + harmonic);
                    rows.set_column(place, &(by_offset * (-sin / ratios[joint])));
                    rows.set_column(place + 1, &(by_offset * (-cos / ratios[joint])));
                }
            }
            equations.extend(rows.row_iter().map(|row| row.iter().copied().collect()));
            residuals.extend((touch.hole - tip.position).iter());
        }
        let step = least_squares(&equations, &residuals, 1)?.values;
        let squares: f64 = residuals.iter().map(|residual| residual * residual).sum();
        found.residual = (squares / residuals.len() as f64).sqrt();
        let p = &mut found.parameters;
        for (index, length) in p.lengths.iter_mut().enumerate() {
            *length += step[index];
        }
        p.offsets = [p.offsets[0] + step[5], p.offsets[1] + step[6]];
        p.origin = [p.origin[0] + step[7], p.origin[1] + step[8]];
        p.turn += step[9];
        for (index, value) in found.terms.iter_mut().flatten().flatten().enumerate() {
            *value += step[10 + index];
        }
    }
    found.residual.is_finite().then_some(found)
}
