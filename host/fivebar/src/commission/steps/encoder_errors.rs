//! Errors of the encoders as further unknowns of the touched holes: two harmonics of each shaft.
//!
//! The shaft shows φ + Σ s_h sin hφ + c_h cos hφ at φ = n θ, so the joint is at the measured angle
//! less that sum over n. Its derivatives are those of the joint's offset times −sin hφ/n and
//! −cos hφ/n.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::fit::least_squares;
use fivebar_design::calibration::{Parameters, Touch, Unknowns, tip};
use fivebar_design::identification::{ENCODER_HARMONICS, EncoderErrors};
use fivebar_files::robot::MeasuredKey;
use fivebar_kinematics::five_bar::{Joint, Side};
use fivebar_plant::EncoderSide;
use nalgebra::SMatrix;
use std::f64::consts::TAU;

/// Lengths, offsets and placement.
const PLAIN: usize = 10;
/// Besides, sine and cosine of each harmonic of both shafts.
const UNKNOWNS: usize = PLAIN + 4 * ENCODER_HARMONICS;
const ROUNDS: usize = 12;

/// The best arm with errors of its encoders.
pub(super) struct WithErrors {
    /// Lengths, offsets and placement.
    pub(super) parameters: Parameters,
    /// Of each joint's shaft.
    pub(super) errors: EncoderErrors,
    /// Root mean square of the residuals [m].
    pub(super) residual: f64,
}

/// Where errors of the encoders come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Errors {
    /// The holes show them.
    Unknown,
    /// They are known.
    Known(EncoderErrors),
}

/// The key of a joint's errors in the robot file.
pub(super) fn key(joint: Joint) -> MeasuredKey {
    MeasuredKey::Actuator(joint, "encoder_error")
}

/// Amplitude and phase of each harmonic of a joint's shaft, as a robot file has them.
pub(super) fn text(errors: &EncoderErrors, joint: Joint) -> String {
    let terms: Vec<String> = (1..)
        .zip(errors.terms[joint])
        .map(|(harmonic, [s, c]): (u32, [f64; 2])| {
            let (amplitude, phase) = (s.hypot(c), c.atan2(s));
            format!("{{ harmonic = {harmonic}, amplitude = {amplitude:.6e}, phase = {phase:.6} }}")
        })
        .collect();
    format!("[{}]", terms.join(", "))
}

/// The errors of the robot file; none if they have other harmonics, or if an encoder is not at its motor.
pub(super) fn in_file(bench: &Bench) -> Result<Option<EncoderErrors>, StepError> {
    let mut errors = EncoderErrors::default();
    for joint in Joint::ALL {
        let drive = bench.drive(joint)?;
        if drive.encoder_side != EncoderSide::Motor {
            return Ok(None);
        }
        for term in drive.encoder_error.terms() {
            let place = (term.harmonic as usize)
                .checked_sub(1)
                .and_then(|place| errors.terms[joint].get_mut(place));
            let Some(place) = place else { return Ok(None) };
            let (sin, cos) = term.phase.sin_cos();
            *place = [term.amplitude * cos, term.amplitude * sin];
        }
    }
    Ok(Some(errors))
}

/// What the encoders show where the joints are at these angles [rad].
pub(super) fn shown(bench: &Bench, angles: [f64; 2]) -> Result<[f64; 2], StepError> {
    let errors = in_file(bench)?.unwrap_or_default();
    let ratios = ratios(bench)?;
    Ok(Joint::ALL.map(|joint| angles[joint] + errors.at(joint, angles[joint], ratios[joint])))
}

/// Both gear ratios.
pub(super) fn ratios(bench: &Bench) -> Result<[f64; 2], StepError> {
    Ok([
        bench.drive(Joint::Joint1)?.gear_ratio,
        bench.drive(Joint::Joint4)?.gear_ratio,
    ])
}

/// Touched holes from rows of counts1, counts4, x, y.
pub(super) fn touches(bench: &Bench, rows: &[[f64; 4]]) -> Result<Vec<Touch>, StepError> {
    let per_turn = [
        bench.counts_per_turn(Joint::Joint1)?,
        bench.counts_per_turn(Joint::Joint4)?,
    ];
    let touch = |row: &[f64; 4]| Touch {
        encoder: Joint::ALL.map(|joint| (row[joint.index()] + 0.5) * TAU / per_turn[joint]),
        hole: [row[2], row[3]].into(),
    };
    Ok(rows.iter().map(touch).collect())
}

/// Fits the arm's free unknowns, and the errors unless they are known, from the arm without errors on; none if the holes do not
/// determine them.
pub(super) fn fit(
    start: &Parameters,
    unknowns: Unknowns,
    touches: &[Touch],
    ratios: [f64; 2],
    assembly: Side,
    errors: Errors,
) -> Option<WithErrors> {
    let (errors, count) = match errors {
        Errors::Unknown => (EncoderErrors::default(), UNKNOWNS),
        Errors::Known(errors) => (errors, PLAIN),
    };
    let free: Vec<usize> = unknowns
        .free()
        .iter()
        .copied()
        .chain(PLAIN..count)
        .collect();
    let mut found = WithErrors {
        parameters: *start,
        errors,
        residual: f64::INFINITY,
    };
    for _ in 0..ROUNDS {
        let (mut equations, mut residuals) = (Vec::new(), Vec::new());
        for touch in touches {
            let p = &found.parameters;
            let theta = Joint::ALL.map(|joint| {
                let shown = touch.encoder[joint] + p.offsets[joint];
                found.errors.corrected(joint, shown, ratios[joint])
            });
            let encoder = Joint::ALL.map(|joint| theta[joint] - p.offsets[joint]);
            let tip = tip(p, encoder, assembly)?;
            let mut rows = SMatrix::<f64, 2, UNKNOWNS>::zeros();
            rows.fixed_columns_mut::<PLAIN>(0).copy_from(&tip.jacobian);
            for joint in Joint::ALL {
                for harmonic in 0..ENCODER_HARMONICS {
                    let phase = (harmonic + 1) as f64 * ratios[joint] * theta[joint];
                    let (sin, cos) = phase.sin_cos();
                    let by_offset = tip.jacobian.column(5 + joint.index());
                    let place = PLAIN + 2 * (ENCODER_HARMONICS * joint.index() + harmonic);
                    rows.set_column(place, &(by_offset * (-sin / ratios[joint])));
                    rows.set_column(place + 1, &(by_offset * (-cos / ratios[joint])));
                }
            }
            let row = rows
                .row_iter()
                .map(|row| free.iter().map(|&index| row[index]).collect());
            equations.extend(row);
            residuals.extend((touch.hole - tip.position).iter());
        }
        let solved = least_squares(&equations, &residuals, 1)?.values;
        let mut step = [0.0; UNKNOWNS];
        for (&index, value) in free.iter().zip(solved) {
            step[index] = value;
        }
        let squares: f64 = residuals.iter().map(|residual| residual * residual).sum();
        found.residual = (squares / residuals.len() as f64).sqrt();
        let p = &mut found.parameters;
        for (index, length) in p.lengths.iter_mut().enumerate() {
            *length += step[index];
        }
        p.offsets = [p.offsets[0] + step[5], p.offsets[1] + step[6]];
        p.origin = [p.origin[0] + step[7], p.origin[1] + step[8]];
        p.turn += step[9];
        let terms = found.errors.terms.iter_mut().flatten().flatten();
        for (term, step) in terms.zip(&step[PLAIN..]) {
            *term += step;
        }
    }
    found.residual.is_finite().then_some(found)
}

#[cfg(test)]
mod tests {
    use super::{Errors, fit};
    use fivebar_design::calibration::{Parameters, Touch, Unknowns};
    use fivebar_design::identification::EncoderErrors;
    use fivebar_kinematics::five_bar::{Geometry, Joint, Side, WorkingMode};
    use nalgebra::Vector2;

    const RATIOS: [f64; 2] = [8.0, 8.0];

    /// 40 holes that an arm touches with these errors of its encoders.
    fn touches(made: &Parameters, errors: &EncoderErrors) -> Vec<Touch> {
        let geometry = Geometry::new(made.lengths).unwrap();
        let mode = WorkingMode::new(Side::Right, Side::Left);
        let touch = |index: usize| {
            let at = |step: usize, of: usize| (index * step % of) as f64 / of as f64;
            let c = Vector2::new(0.2 * at(7, 40) - 0.09, 0.08 * at(11, 37) + 0.13);
            let [theta1, _, _, theta4] = geometry.inverse(c, mode).unwrap().angles();
            let shown = |joint: Joint, theta: f64| {
                theta + errors.at(joint, theta, RATIOS[joint]) - made.offsets[joint]
            };
            Touch {
                encoder: [shown(Joint::Joint1, theta1), shown(Joint::Joint4, theta4)],
                hole: c + Vector2::from(made.origin),
            }
        };
        (0..40).map(touch).collect()
    }

    #[test]
    fn errors_of_the_encoders_are_found_with_a_base_and_without() {
        for base in [0.08, 0.0] {
            let made = Parameters {
                lengths: [0.1001, 0.1598, 0.1603, 0.0999, base],
                offsets: [2e-3, -1e-3],
                origin: [0.01, 0.02],
                turn: 0.0,
            };
            let mut errors = EncoderErrors::default();
            errors.terms[0][0] = [2e-3, 1e-3];
            errors.terms[1][0] = [-1e-3, 2e-3];
            let start = Parameters {
                lengths: [0.10, 0.16, 0.16, 0.10, base],
                origin: made.origin,
                ..Parameters::default()
            };
            let (unknowns, touches) = (Unknowns::of(start.lengths), touches(&made, &errors));
            let found = fit(
                &start,
                unknowns,
                &touches,
                RATIOS,
                Side::Left,
                Errors::Unknown,
            );
            let found = found.expect("the holes determine the arm");
            assert!(found.residual < 1e-9, "{base}: {}", found.residual);
            let pairs = found.errors.terms.iter().zip(&errors.terms);
            for (own, wanted) in pairs.flat_map(|(own, wanted)| own.iter().zip(wanted)) {
                let off = [0, 1].map(|k| (own[k] - wanted[k]).abs());
                assert!(off[0].max(off[1]) < 1e-7, "{base}: {own:?} for {wanted:?}");
            }
        }
    }
}
