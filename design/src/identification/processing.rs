//! From a log to rows of a linear system.
//!
//! The angles are filtered and differentiated, the regressor is computed from them, and its
//! columns are filtered again. The torques are filtered twice, and so is the sign of the
//! velocity, so that all terms have passed the same filter. The current of row k acts from tick
//! k − 1 to k, so the torque at tick k is the mean of rows k and k + 1. After the filter, one
//! row in some dozens holds all there is to know; the rest is dropped.

use super::filter::LowPass;
use super::log::Observed;
use super::regressor::Regressor;
use fivebar_kinematics::five_bar::PoseError;
use nalgebra::{DMatrix, DVector};

/// The cut-off of the filter [Hz]; an excitation of a few hertz lies well below.
pub(super) const CUTOFF: f64 = 60.0;

/// Velocities within which Coulomb friction changes its sign [rad/s]; the one that explains the
/// torques best is taken. Were it wrong, slow motions would err by some per cent of the friction.
const SIGN_WIDTHS: [f64; 6] = [1e-6, 5e-3, 1e-2, 2e-2, 5e-2, 0.1];

/// The linear system: two blocks of rows, of joint 1 and of joint 4.
#[derive(Clone)]
pub(super) struct System {
    /// The columns: base parameters, then viscous of both joints, Coulomb of both, offsets of both.
    pub(super) matrix: [DMatrix<f64>; 2],
    /// The torques [N·m].
    pub(super) torque: [DVector<f64>; 2],
}

/// The systems of a log with continuous angles [rad] and torques [N·m], one for each width of the
/// sign.
pub(super) fn systems(
    angles: &[Vec<f64>; 2],
    torques: &[Vec<f64>; 2],
    observed: &Observed<'_>,
) -> Result<Vec<System>, PoseError> {
    let rate = observed.tick_rate;
    let filter = LowPass::new(CUTOFF.min(0.2 * rate), rate);
    let base = observed.base_count();
    let columns = base + 6;
    let rows = angles[0].len();
    let smooth = [filter.apply(&angles[0]), filter.apply(&angles[1])];
    let mut raw = vec![vec![0.0; rows]; 2 * base];
    let mut velocities = [vec![0.0; rows], vec![0.0; rows]];
    for row in 1..rows - 1 {
        let [q1, q4] = [&smooth[0][row - 1..=row + 1], &smooth[1][row - 1..=row + 1]];
        let velocity = |q: &[f64]| (q[2] - q[0]) * (0.5 * rate);
        let acceleration = |q: &[f64]| ((q[2] - q[1]) - (q[1] - q[0])) * (rate * rate);
        let omega = [velocity(q1), velocity(q4)];
        let motion = [[q1[1], q4[1]], omega, [acceleration(q1), acceleration(q4)]];
        let at = Regressor::at(
            observed.geometry,
            observed.assembly,
            observed.gravity,
            motion,
        );
        let at = at?;
        for index in 0..base {
            let [of1, of4] = at.base(index);
            raw[index][row] = of1;
            raw[base + index][row] = of4;
        }
        velocities[0][row] = omega[0];
        velocities[1][row] = omega[1];
    }
    let edge = filter.settling() + 2;
    let every = ((rate / (4.0 * CUTOFF)) as usize).max(1);
    let kept: Vec<usize> = (edge..rows.saturating_sub(edge)).step_by(every).collect();
    let pick = |values: &[f64]| kept.iter().map(|&row| values[row]).collect::<Vec<f64>>();
    let mut matrix = [
        DMatrix::zeros(kept.len(), columns),
        DMatrix::zeros(kept.len(), columns),
    ];
    for joint in 0..2 {
        let own = &mut matrix[joint];
        for index in 0..base {
            let filtered = filter.apply(&raw[joint * base + index]);
            own.set_column(index, &DVector::from_vec(pick(&filtered)));
        }
        let velocity = &velocities[joint];
        own.set_column(
            base + joint,
            &DVector::from_vec(pick(&filter.apply(velocity))),
        );
        own.column_mut(base + 4 + joint).fill(1.0);
    }
    let torque = [0, 1].map(|joint| {
        let current: &[f64] = &torques[joint];
        let mut at_tick: Vec<f64> = current
            .windows(2)
            .map(|two| 0.5 * (two[0] + two[1]))
            .collect();
        at_tick.extend(current.last());
        DVector::from_vec(pick(&filter.apply(&filter.apply(&at_tick))))
    });
    let plain = System { matrix, torque };
    let with_signs = |width: f64| {
        let mut system = plain.clone();
        for (joint, velocity) in velocities.iter().enumerate() {
            let signs: Vec<f64> = velocity
                .iter()
                .map(|omega| smooth_sign(*omega, width))
                .collect();
            let signs = filter.apply(&filter.apply(&signs));
            system.matrix[joint].set_column(base + 2 + joint, &DVector::from_vec(pick(&signs)));
        }
        system
    };
    Ok(SIGN_WIDTHS.into_iter().map(with_signs).collect())
}

/// The sign of a velocity, continuous within ± `width` [rad/s].
pub(super) fn smooth_sign(omega: f64, width: f64) -> f64 {
    let x = omega / width;
    x / (1.0 + x * x).sqrt()
}
