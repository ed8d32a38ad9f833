//! The excitation within its limits that distinguishes the parameters of an arm best.

use super::excitation::{Excitation, HARMONICS};
use super::least_squares::scales;
use super::processing::smooth_sign;
use super::regressor::Regressor;
use crate::Noise;
use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
use nalgebra::{DMatrix, Vector2};

/// What an excitation must keep within, and the arm as drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// The lengths.
    pub geometry: Geometry<f64>,
    /// The assembly mode.
    pub assembly: Side,
    /// The working mode of C.
    pub mode: WorkingMode,
    /// In the plane [m/s²].
    pub gravity: Vector2<f64>,
    /// Base parameters as drawn; all 11.
    pub base: [f64; 11],
    /// Viscous [N·m·s/rad] and Coulomb [N·m] friction of joints 1 and 4 as drawn.
    pub friction: [[f64; 2]; 2],
    /// Least and greatest angle of each joint [rad].
    pub angle: [[f64; 2]; 2],
    /// Greatest velocity of each joint [rad/s].
    pub velocity: [f64; 2],
    /// Greatest acceleration of each joint [rad/s²].
    pub acceleration: [f64; 2],
    /// Greatest torque of each joint [N·m].
    pub torque: [f64; 2],
    /// Greatest root mean square of the torque of each joint [N·m].
    pub torque_rms: [f64; 2],
    /// Least |sin| at the elbows and at C.
    pub margin: f64,
    /// The joint angles about which the search begins [rad].
    pub middle: [f64; 2],
}

/// An excitation within the bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProposedExcitation {
    /// The trajectory.
    pub excitation: Excitation,
    /// Condition of the regressor with J in 1e-3 kg·m², h in 1e-2 kg·m, friction in 1e-2.
    pub condition: f64,
}

/// Instants of a period at which a trajectory is judged during the search.
const COARSE: usize = 48;
/// Instants of a period at which the result is judged: every 5 ms.
const FINE: usize = 250;
/// The period of a trajectory [s]: the first harmonic is 0.8 Hz, the fifth 4 Hz.
const PERIOD: f64 = 1.25;

/// An excitation by a random search from a seed; none if no trajectory within the bounds was
/// found.
pub fn propose_excitation(bounds: &Bounds, seed: u64) -> Option<ProposedExcitation> {
    let mut noise = Noise::new(seed);
    let mut best: Option<([f64; 22], f64)> = None;
    // From several starts for a while, then from the best of them.
    for start in 0..6 {
        let first = random_start(bounds, &mut noise);
        let found = search(bounds, first, 700, 1.0, &mut noise);
        if start == 0 || best.is_none_or(|(_, cost)| found.1 < cost) {
            best = Some(found);
        }
    }
    let (mut x, _) = best?;
    // The finer look may show that bounds are left between the instants: then the trajectory is
    // made smaller.
    (x, _) = search(bounds, x, 6000, 0.3, &mut noise);
    for _ in 0..40 {
        let (penalty, condition) = judge(bounds, &x, FINE);
        if penalty == 0.0 {
            let excitation = Excitation {
                period: PERIOD,
                coefficients: x,
            };
            return Some(ProposedExcitation {
                excitation,
                condition,
            });
        }
        for joint in 0..2 {
            for value in &mut x[11 * joint + 1..11 * (joint + 1)] {
                *value *= 0.98;
            }
        }
    }
    None
}

fn random_start(bounds: &Bounds, noise: &mut Noise) -> [f64; 22] {
    let mut x = [0.0; 22];
    for joint in 0..2 {
        x[11 * joint] = bounds.middle[joint] + 0.1 * noise.normal();
        for value in &mut x[11 * joint + 1..11 * (joint + 1)] {
            *value = 0.07 * bounds.velocity[joint] * noise.normal();
        }
    }
    x
}

/// The best trajectory near one: steps of a size that grows with success and shrinks without.
fn search(
    bounds: &Bounds,
    mut x: [f64; 22],
    tries: usize,
    mut size: f64,
    noise: &mut Noise,
) -> ([f64; 22], f64) {
    let cost_of = |x: &[f64; 22]| {
        let (penalty, condition) = judge(bounds, x, COARSE);
        libm::log(condition) + 20.0 * penalty
    };
    let mut cost = cost_of(&x);
    for _ in 0..tries {
        let mut next = x;
        // One, some or all of the coefficients move.
        let share = [0.1, 0.3, 1.0][(3.0 * noise.uniform()) as usize];
        for (index, value) in next.iter_mut().enumerate() {
            if noise.uniform() < share {
                let joint = index / 11;
                let unit = if index % 11 == 0 {
                    0.1
                } else {
                    0.07 * bounds.velocity[joint]
                };
                *value += size * unit * noise.normal();
            }
        }
        let tried = cost_of(&next);
        if tried < cost {
            (x, cost) = (next, tried);
            size = (1.5 * size).min(1.0);
        } else {
            size = (0.98 * size).max(0.01);
        }
    }
    (x, cost)
}

/// How far a trajectory is beyond its bounds, as a share summed over instants, and its condition.
fn judge(bounds: &Bounds, x: &[f64; 22], instants: usize) -> (f64, f64) {
    let trajectory = Excitation {
        period: PERIOD,
        coefficients: *x,
    };
    let base = if bounds.gravity == Vector2::zeros() {
        7
    } else {
        11
    };
    let scales = scales(base);
    let mut matrix = DMatrix::zeros(2 * instants, base + 6);
    let mut penalty = 0.0;
    let mut squares = [0.0; 2];
    for instant in 0..instants {
        let motion = trajectory.at(PERIOD * instant as f64 / instants as f64);
        let [q, omega, alpha] = motion;
        for joint in 0..2 {
            let [least, greatest] = bounds.angle[joint];
            penalty += (least - q[joint]).max(0.0) + (q[joint] - greatest).max(0.0);
            penalty += (omega[joint].abs() / bounds.velocity[joint] - 1.0).max(0.0);
            penalty += (alpha[joint].abs() / bounds.acceleration[joint] - 1.0).max(0.0);
        }
        let at = Regressor::at(&bounds.geometry, bounds.assembly, bounds.gravity, motion);
        let Ok(at) = at else {
            penalty += 3.0;
            continue;
        };
        let pose = &at.pose;
        for sine in [pose.sin21(), pose.sin34(), pose.sin32()] {
            penalty += 2.0 * (bounds.margin - sine.abs()).max(0.0);
        }
        if pose.working_mode() != bounds.mode {
            penalty += 1.0;
        }
        let drawn = at.torque(&bounds.base);
        for joint in 0..2 {
            let row = 2 * instant + joint;
            for index in 0..base {
                matrix[(row, index)] = at.base(index)[joint] * scales[index];
            }
            let sign = smooth_sign(omega[joint], 0.02);
            matrix[(row, base + joint)] = omega[joint] * scales[base];
            matrix[(row, base + 2 + joint)] = sign * scales[base];
            matrix[(row, base + 4 + joint)] = scales[base];
            let [viscous, coulomb] = bounds.friction[joint];
            let torque = drawn[joint] + viscous * omega[joint] + coulomb * sign;
            penalty += (torque.abs() / bounds.torque[joint] - 1.0).max(0.0);
            squares[joint] += torque * torque / instants as f64;
        }
    }
    for (square, bound) in squares.iter().zip(bounds.torque_rms) {
        let over = square.sqrt() / bound - 1.0;
        penalty += instants as f64 * over.max(0.0);
    }
    let values = matrix.tr_mul(&matrix).symmetric_eigenvalues();
    let condition = (values.max() / values.min().max(1e-300)).sqrt();
    (penalty / instants as f64, condition)
}

const _: () = assert!(
    HARMONICS == 5,
    "the coefficients are laid out for five harmonics"
);
