//! How well an arm's torques are predicted along a log from which nothing was identified.

use super::check::{check_mode, check_motion, check_times};
use super::error::IdentificationError;
use super::log::{Log, Observed};
use super::processing::systems;
use nalgebra::DVector;

/// What predicts torques.
#[derive(Clone, Debug, PartialEq)]
pub struct Predictor {
    /// Base parameters in the order of [`BASE_NAMES`](super::BASE_NAMES) [kg·m², kg·m]; those that
    /// gravity shows are ignored on a level arm.
    pub base: Vec<f64>,
    /// Viscous friction [N·m·s/rad].
    pub viscous: [f64; 2],
    /// Coulomb friction [N·m].
    pub coulomb: [f64; 2],
    /// What the measured torque has more [N·m].
    pub offset: [f64; 2],
}

/// The torques of a log and what of them is not predicted, filtered as for an identification.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misprediction {
    /// Root mean square of what is not predicted, of both joints [N·m].
    pub rms: f64,
    /// Root mean square of the torques [N·m].
    pub torque_rms: f64,
}

/// Compares the torques of a log with predicted ones.
///
/// # Errors
/// What is wrong with the log.
pub fn validate(
    log: &Log,
    observed: &Observed<'_>,
    predictor: &Predictor,
) -> Result<Misprediction, IdentificationError> {
    check_times(log, observed.tick_rate)?;
    let angles = check_motion(log, observed)?;
    check_mode(&angles, observed)?;
    let systems = systems(&angles, &log.torques(observed), observed);
    let systems = systems.map_err(|_| IdentificationError::OtherMode(0.01))?;
    let base = observed.base_count();
    let Predictor {
        viscous,
        coulomb,
        offset,
        ..
    } = predictor;
    let friction = [viscous, coulomb, offset].into_iter().flatten();
    let values: Vec<f64> = (predictor.base.iter().take(base))
        .chain(friction)
        .copied()
        .collect();
    let values = DVector::from_vec(values);
    let mean_square = |blocks: [DVector<f64>; 2]| {
        let rows = (blocks[0].len() + blocks[1].len()).max(1) as f64;
        blocks.iter().map(DVector::norm_squared).sum::<f64>() / rows
    };
    let of = systems.into_iter().map(|system| {
        let wrong = [0, 1].map(|joint| &system.torque[joint] - &system.matrix[joint] * &values);
        Misprediction {
            rms: mean_square(wrong).sqrt(),
            torque_rms: mean_square(system.torque).sqrt(),
        }
    });
    // As in the identification, of the widths of the sign the one that predicts best.
    of.min_by(|a, b| a.rms.total_cmp(&b.rms))
        .ok_or_else(|| IdentificationError::NotSeen(vec!["anything".into()], f64::INFINITY))
}
