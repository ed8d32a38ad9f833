//! Errors of encoders from the torques of a fast motion.
//!
//! An encoder on a motor's shaft shows φ + Σ sₕ sin hφ + cₕ cos hφ at φ = n θ. While the joint turns at ω the error
//! waves at h n ω, and the arm does not: of a motion that is taken for the encoder's, the torque M(q) q̈ has waves that
//! no current has made, greater with the square of the speed. Cogging and friction wave, too, but not more at a higher
//! speed. The errors are found together with the masses by least squares, the errors by Gauss's and Newton's method:
//! the derivatives of the predicted torques by sₕ and cₕ are differences.

use super::check::{check_mode, check_motion, check_times};
use super::error::IdentificationError;
use super::least_squares::{Solution, scales, solve};
use super::log::{Log, Observed};
use super::processing::{System, systems};
use fivebar_kinematics::five_bar::Joint;
use nalgebra::{DMatrix, DVector};

/// Harmonics of each shaft: the first is the eccentricity of a magnet or a disc, the second its tilt.
pub const ENCODER_HARMONICS: usize = 2;

const UNKNOWNS: usize = 4 * ENCODER_HARMONICS;
/// The difference by which derivatives are taken, an angle of the shaft [rad].
const STEP: f64 = 1e-4;
const ROUNDS: usize = 5;
/// A joint that is slower tells nothing of its encoder, and its friction is not what the model has [rad/s].
const FAST: f64 = 1.0;

/// Errors of both encoders: sₕ and cₕ of each harmonic of each joint's shaft [rad].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EncoderErrors {
    /// Of joint 1 and of joint 4.
    pub terms: [[[f64; 2]; ENCODER_HARMONICS]; 2],
}

impl EncoderErrors {
    /// The error of a joint's angle with the joint at `theta` and its shaft at `ratio` times that [rad].
    pub fn at(&self, joint: Joint, theta: f64, ratio: f64) -> f64 {
        let sum = (1..).zip(self.terms[joint]).map(|(harmonic, [s, c])| {
            let (sin, cos) = (f64::from(harmonic) * ratio * theta).sin_cos();
            s * sin + c * cos
        });
        sum.sum::<f64>() / ratio
    }

    /// The joint's angle where its encoder shows `shown` [rad].
    pub fn corrected(&self, joint: Joint, shown: f64, ratio: f64) -> f64 {
        // The error changes by a hundredth of the angle at most.
        (0..4).fold(shown, |theta, _| shown - self.at(joint, theta, ratio))
    }

    fn changed(mut self, by: &DVector<f64>) -> Self {
        let terms = self.terms.iter_mut().flatten().flatten();
        for (term, by) in terms.zip(by.iter()) {
            *term += by;
        }
        self
    }
}

/// What a motion tells of the encoders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundErrors {
    /// The errors.
    pub errors: EncoderErrors,
    /// Root mean square of the torque that is not explained, with the errors of the start and with those that were
    /// found [N·m].
    pub rms: [f64; 2],
}

/// Finds the errors of encoders on shafts that turn `ratios` times as fast as their joints. The angles of the log are
/// what the encoders show; the errors are searched from `start` on.
///
/// # Errors
/// What is wrong with the log, or that its motion does not determine them.
pub fn identify_encoders(
    log: &Log,
    observed: &Observed<'_>,
    ratios: [f64; 2],
    start: EncoderErrors,
) -> Result<FoundErrors, IdentificationError> {
    check_times(log, observed.tick_rate)?;
    let shown = check_motion(log, observed)?;
    check_mode(&shown, observed)?;
    let torques = log.torques(observed);
    let scales = scales(observed.base_count());
    let undetermined =
        || IdentificationError::NotSeen(vec!["errors of the encoders".into()], f64::INFINITY);
    let at = |errors: &EncoderErrors| {
        let angles = Joint::ALL.map(|joint| {
            let corrected = |&shown: &f64| errors.corrected(joint, shown, ratios[joint]);
            shown[joint].iter().map(corrected).collect()
        });
        systems(&angles, &torques, observed).map_err(|_| IdentificationError::OtherMode(0.01))
    };
    let best = |all: &[System]| -> Option<(usize, Solution)> {
        let solved = all.iter().enumerate();
        let solved = solved.filter_map(|(width, system)| Some((width, solve(system, &scales)?)));
        solved.min_by(|(_, a), (_, b)| whole(a).total_cmp(&whole(b)))
    };
    let mut errors = start;
    let mut first = None;
    for _ in 0..ROUNDS {
        let now = at(&errors)?;
        let (width, solution) = best(&now).ok_or_else(undetermined)?;
        first.get_or_insert(whole(&solution));
        let predicted =
            |system: &System| Joint::ALL.map(|joint| &system.matrix[joint] * &solution.value);
        let before = predicted(&now[width]);
        let mut slopes = [0, 1].map(|joint| DMatrix::zeros(before[joint].len(), UNKNOWNS));
        for unknown in 0..UNKNOWNS {
            let mut by = DVector::zeros(UNKNOWNS);
            by[unknown] = STEP;
            let after = predicted(&at(&errors.changed(&by))?[width]);
            for joint in 0..2 {
                let slope = (&after[joint] - &before[joint]) / STEP;
                slopes[joint].set_column(unknown, &slope);
            }
        }
        let change = step(&now[width], &slopes, &solution, &scales).ok_or_else(undetermined)?;
        errors = errors.changed(&change);
    }
    let (_, last) = best(&at(&errors)?).ok_or_else(undetermined)?;
    Ok(FoundErrors {
        errors,
        rms: [first.unwrap_or(f64::NAN), whole(&last)],
    })
}

/// Root mean square of both joints' residuals [N·m].
fn whole(solution: &Solution) -> f64 {
    let [rms1, rms4] = solution.rms;
    (0.5 * (rms1 * rms1 + rms4 * rms4)).sqrt()
}

/// The change of the errors that explains most of what is left, together with a change of the masses.
fn step(
    system: &System,
    slopes: &[DMatrix<f64>; 2],
    solution: &Solution,
    scales: &DVector<f64>,
) -> Option<DVector<f64>> {
    let linear = scales.len();
    let size = linear + UNKNOWNS;
    let mut normal = DMatrix::zeros(size, size);
    let mut right = DVector::zeros(size);
    for joint in Joint::ALL {
        let mut matrix = DMatrix::zeros(slopes[joint].nrows(), size);
        for (column, scale) in scales.iter().enumerate() {
            matrix.set_column(column, &(system.matrix[joint].column(column) * *scale));
        }
        for unknown in 0..UNKNOWNS {
            let column = slopes[joint].column(unknown) * STEP;
            matrix.set_column(linear + unknown, &column);
        }
        let mut residual = &system.torque[joint] - &system.matrix[joint] * &solution.value;
        let velocity = system.matrix[joint].column(linear - 6 + joint.index());
        for (row, velocity) in velocity.iter().enumerate() {
            if velocity.abs() < FAST {
                matrix.row_mut(row).fill(0.0);
                residual[row] = 0.0;
            }
        }
        let weight = 1.0 / (solution.rms[joint] * solution.rms[joint]).max(1e-18);
        normal += matrix.tr_mul(&matrix) * weight;
        right += matrix.tr_mul(&residual) * weight;
    }
    let change = normal.cholesky()?.solve(&right);
    Some(change.rows(linear, UNKNOWNS) * STEP)
}

#[cfg(test)]
mod tests {
    use super::{EncoderErrors, identify_encoders};
    use crate::identification::{Log, Observed, Regressor};
    use core::f64::consts::TAU;
    use fivebar_kinematics::five_bar::{Geometry, Joint, Side};
    use nalgebra::Vector2;

    const RATE: f64 = 2000.0;
    const RATIOS: [f64; 2] = [8.0, -6.0];
    const BASE: [f64; 7] = [2.2e-3, 2.0e-3, 1.3e-3, 8e-4, 7e-3, 1e-4, -1e-4];

    const ERRORS: EncoderErrors = EncoderErrors {
        terms: [
            [[2.3e-3, 0.9e-3], [-0.3e-3, 0.9e-3]],
            [[-2.1e-3, 1.3e-3], [1.0e-3, 0.2e-3]],
        ],
    };

    /// A motion of both joints, up to about 10 rad/s, as encoders with these errors show it, with motors that cog by
    /// `cogging` [N·m], and `counts` per turn of a joint.
    fn log(geometry: &Geometry<f64>, errors: &EncoderErrors, cogging: f64, counts: f64) -> Log {
        let motion = |time: f64| {
            let joint = |middle: f64, waves: [[f64; 3]; 3]| {
                waves
                    .iter()
                    .fold([middle, 0.0, 0.0], |[q, v, a], [size, rate, phase]| {
                        let omega = TAU * rate;
                        let (sin, cos) = (omega * time + phase).sin_cos();
                        [
                            q + size * sin,
                            v + size * omega * cos,
                            a - size * omega * omega * sin,
                        ]
                    })
            };
            [
                joint(2.2, [[0.5, 1.3, 0.0], [0.2, 2.9, 1.0], [0.05, 4.7, 2.0]]),
                joint(0.9, [[0.45, 1.7, 0.4], [0.2, 2.3, 2.2], [0.06, 5.3, 0.7]]),
            ]
        };
        let torques = |time: f64| {
            let [[q1, v1, a1], [q4, v4, a4]] = motion(time);
            let (q, v) = ([q1, q4], [v1, v4]);
            let at = [q, v, [a1, a4]];
            let at = Regressor::at(geometry, Side::Left, Vector2::zeros(), at).unwrap();
            let torque = at.torque(&BASE);
            [0, 1].map(|j| {
                let wave = cogging * (12.0 * RATIOS[j] * q[j]).sin();
                torque[j] + 2e-3 * v[j] + 0.012 * (v[j] / 0.05).tanh() + wave
            })
        };
        let mut log = Log::default();
        for row in 0..(6.0 * RATE) as u32 {
            let time = f64::from(row) / RATE;
            let [[q1, ..], [q4, ..]] = motion(time);
            let shown = Joint::ALL.map(|joint| {
                let q = [q1, q4][joint];
                let shown = q + errors.at(joint, q, RATIOS[joint]);
                (shown * counts / TAU).floor() * TAU / counts + 0.5 * TAU / counts
            });
            log.times.push(time);
            log.angles.push(shown);
            // It acted since the row before.
            log.currents.push(torques(time - 0.5 / RATE));
        }
        log
    }

    fn found(errors: &EncoderErrors, cogging: f64) -> super::FoundErrors {
        let geometry = Geometry::new([0.1, 0.16, 0.16, 0.1, 0.08]).unwrap();
        let observed = Observed {
            geometry: &geometry,
            assembly: Side::Left,
            mode: geometry
                .forward(2.2, 0.9, Side::Left)
                .unwrap()
                .working_mode(),
            gravity: Vector2::zeros(),
            torque_per_ampere: [1.0; 2],
            current_limit: [10.0; 2],
            tick_rate: RATE,
        };
        let log = log(&geometry, errors, cogging, 131_072.0);
        identify_encoders(&log, &observed, RATIOS, EncoderErrors::default()).unwrap()
    }

    fn farthest(a: &EncoderErrors, b: &EncoderErrors) -> f64 {
        let both = a
            .terms
            .iter()
            .flatten()
            .flatten()
            .zip(b.terms.iter().flatten().flatten());
        both.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn errors_of_encoders_are_found_from_the_torques_of_a_fast_motion() {
        for cogging in [0.0, 2e-3] {
            let found = found(&ERRORS, cogging);
            let farthest = farthest(&found.errors, &ERRORS);
            assert!(farthest < 1.5e-4, "{farthest} rad: {found:?}");
            assert!(found.rms[1] < 0.7 * found.rms[0], "{found:?}");
        }
    }

    #[test]
    fn encoders_without_errors_explain_nothing() {
        for cogging in [0.0, 2e-3] {
            let found = found(&EncoderErrors::default(), cogging);
            assert!(found.rms[1] > 0.96 * found.rms[0], "{found:?}");
            assert!(farthest(&found.errors, &EncoderErrors::default()) < 1.5e-4);
        }
    }

    #[test]
    fn a_shown_angle_is_corrected() {
        for joint in Joint::ALL {
            for step in 0..100_u32 {
                let (theta, ratio) = (0.03 * f64::from(step), RATIOS[joint]);
                let shown = theta + ERRORS.at(joint, theta, ratio);
                let corrected = ERRORS.corrected(joint, shown, ratio);
                assert!((corrected - theta).abs() < 1e-11);
            }
        }
    }
}
