//! The payload alone, of an arm whose masses are known.
//!
//! A mass m at C adds m δβ to the base parameters, where δβ are those of a payload of 1 kg and
//! nothing else. With τ0 = Y_b β0 of the arm without payload, least squares on
//! τ − τ0 = m Y_b δβ + friction and offsets find m: seven unknowns in place of 13 or 17, so that a
//! short motion of any kind determines them.

use super::arm_masses::{base_parameters, standard_parameters};
use super::check::{check_mode, check_motion, check_times};
use super::error::IdentificationError;
use super::estimate::GREATEST_SHARE;
use super::least_squares::{Solution, solve};
use super::log::{Log, Observed};
use super::processing::{System, systems};
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::Joint;
use nalgebra::{DMatrix, DVector};

/// A payload found by its inertia, and its weight if gravity is in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Payload {
    /// Mass at C [kg].
    pub mass: f64,
    /// Its standard deviation [kg].
    pub sd: f64,
    /// Root mean square of the filtered torque that is not explained [N·m].
    pub residual_rms: [f64; 2],
}

/// The unit in which the mass is sought [kg]; friction and offsets are in units of 1e-2.
const UNIT: f64 = 0.1;

/// Finds the payload of an arm with known masses; what payload `arm` has is left out of account.
///
/// # Errors
/// What is wrong with the log, or that its motion does not determine the payload.
pub fn identify_payload(
    log: &Log,
    observed: &Observed<'_>,
    arm: &Arm<f64>,
) -> Result<Payload, IdentificationError> {
    check_times(log, observed.tick_rate)?;
    let angles = check_motion(log, observed)?;
    check_mode(&angles, observed)?;
    let systems = systems(&angles, &log.torques(observed), observed);
    let systems = systems.map_err(|_| IdentificationError::OtherMode(0.01))?;
    let lengths = observed.geometry.lengths();
    let with = base_parameters(lengths, &standard_parameters(arm));
    let unit = of_one_kilogram(lengths);
    let count = observed.base_count();
    let of = |values: &dyn Fn(usize) -> f64| DVector::from_fn(count, |index, _| values(index));
    let known = of(&|index| with[index] - arm.payload() * unit[index]);
    let added = of(&|index| unit[index]);
    let scales = DVector::from_fn(7, |index, _| if index == 0 { UNIT } else { 1e-2 });
    let solutions = systems.iter().filter_map(|system| {
        let reduced = reduced(system, &known, &added);
        solve(&reduced, &scales)
    });
    let unexplained = |solution: &Solution| solution.rms[0] * solution.rms[1];
    let found = solutions.min_by(|a, b| unexplained(a).total_cmp(&unexplained(b)));
    let name = || vec!["the payload".to_owned()];
    let found = found.ok_or_else(|| IdentificationError::NotSeen(name(), f64::INFINITY))?;
    // A payload below nothing, or unknown to a tenth of a kilogram, was not seen.
    if found.sd[0] > UNIT || found.value[0] < -found.sd[0] - 0.01 * UNIT {
        return Err(IdentificationError::NoPayload(found.value[0], found.sd[0]));
    }
    for (joint, rms) in Joint::ALL.into_iter().zip(found.rms) {
        let torque = &systems[0].torque[joint];
        let share = rms
            / (torque.norm_squared() / torque.len() as f64)
                .sqrt()
                .max(1e-12);
        if share > GREATEST_SHARE {
            return Err(IdentificationError::Unexplained(joint, share));
        }
    }
    Ok(Payload {
        mass: found.value[0],
        sd: found.sd[0],
        residual_rms: found.rms,
    })
}

/// The base parameters of a payload of 1 kg and nothing else.
fn of_one_kilogram(lengths: [f64; 5]) -> [f64; 11] {
    let l2 = lengths[1];
    let mut standard = [0.0; 16];
    // m2, h2x, J2.
    (standard[4], standard[5], standard[7]) = (1.0, l2, l2 * l2);
    base_parameters(lengths, &standard)
}

/// The system with one column for the payload in place of those of the base parameters.
fn reduced(system: &System, known: &DVector<f64>, added: &DVector<f64>) -> System {
    let count = known.len();
    let base = |joint: Joint| system.matrix[joint].columns(0, count);
    let matrix = Joint::ALL.map(|joint| {
        let rest = system.matrix[joint].columns(count, 6);
        let mut own = DMatrix::zeros(rest.nrows(), 7);
        own.set_column(0, &(base(joint) * added));
        own.columns_mut(1, 6).copy_from(&rest);
        own
    });
    let torque = Joint::ALL.map(|joint| &system.torque[joint] - base(joint) * known);
    System { matrix, torque }
}
