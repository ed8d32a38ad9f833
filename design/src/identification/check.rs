//! Checks of a log before its identification.

use super::error::IdentificationError;
use super::log::{Log, Observed};
use core::f64::consts::TAU;
use fivebar_kinematics::five_bar::{Geometry, Joint};

/// The most rows that are read: five minutes at 10 kHz.
const MOST_ROWS: usize = 3_000_000;

/// Refuses rows that do not come at the tick rate, and values that are not finite.
pub(super) fn check_times(log: &Log, rate: f64) -> Result<(), IdentificationError> {
    let rows = log.times.len();
    if rows > MOST_ROWS {
        return Err(IdentificationError::TooLong(MOST_ROWS));
    }
    for row in 0..rows {
        let [q1, q4] = log.angles[row];
        let [i1, i4] = log.currents[row];
        if ![log.times[row], q1, q4, i1, i4]
            .iter()
            .all(|x| x.is_finite())
        {
            return Err(IdentificationError::NotFinite(row + 1));
        }
    }
    let mut steps: Vec<f64> = log.times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let step = |steps: &mut Vec<f64>| {
        let middle = steps.len() / 2;
        *steps.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    if rows < 2 {
        return Err(IdentificationError::TooShort(0.0));
    }
    let whole = log.times[rows - 1] - log.times[0];
    let typical = step(&mut steps);
    // The mean of the steps that are no gaps: times may be rounded.
    let regular = |step: &&f64| (0.5 * typical..=1.5 * typical).contains(*step);
    let sum: f64 = steps.iter().filter(regular).sum();
    let mean = sum / steps.iter().filter(regular).count().max(1) as f64;
    if !(mean > 0.0 && (mean * rate - 1.0).abs() < 0.02) {
        return Err(IdentificationError::Rate(1.0 / mean, rate));
    }
    for (row, pair) in log.times.windows(2).enumerate() {
        let passed = pair[1] - pair[0];
        if !(0.5..=1.5).contains(&(passed * rate)) {
            return Err(IdentificationError::Gap(row + 1, passed));
        }
    }
    if whole < 0.5 {
        return Err(IdentificationError::TooShort(whole));
    }
    Ok(())
}

/// The angles without turns; refuses jumps, joints at rest and currents at their limit.
pub(super) fn check_motion(
    log: &Log,
    observed: &Observed<'_>,
) -> Result<[Vec<f64>; 2], IdentificationError> {
    let mut angles = [Vec::new(), Vec::new()];
    for joint in Joint::ALL {
        let mut turns = 0.0;
        let mut last = log.angles[0][joint];
        let own: &mut Vec<f64> = &mut angles[joint];
        for (row, angle) in log.angles.iter().enumerate() {
            let step = angle[joint] - last;
            turns -= (step / TAU).round() * TAU;
            // 0.3 rad in a tick are 3,000 rad/s at 10 kHz.
            if (step - (step / TAU).round() * TAU).abs() > 0.3 {
                return Err(IdentificationError::Jump(joint, row));
            }
            last = angle[joint];
            own.push(angle[joint] + turns);
        }
        let least = own.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = own.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if greatest - least < 0.02 {
            return Err(IdentificationError::Still(joint, greatest - least));
        }
        let limit = 0.995 * observed.current_limit[joint];
        let at_limit = log.currents.iter().filter(|row| row[joint].abs() >= limit);
        let at_limit = at_limit.count();
        let in_a_row = log
            .currents
            .windows(5)
            .any(|rows| rows.iter().all(|row| row[joint].abs() >= limit));
        if in_a_row || 1000 * at_limit > log.currents.len() {
            return Err(IdentificationError::Saturated(joint, at_limit));
        }
    }
    Ok(angles)
}

/// Refuses angles with which the arm has no pose in its working mode.
pub(super) fn check_mode(
    angles: &[Vec<f64>; 2],
    observed: &Observed<'_>,
) -> Result<(), IdentificationError> {
    let [first, second] = angles;
    let lost = lost_share(observed.geometry, observed, [first, second]);
    if lost <= 0.02 {
        return Ok(());
    }
    if lost_share(observed.geometry, observed, [second, first]) <= 0.02 {
        return Err(IdentificationError::SwappedAngles);
    }
    Err(IdentificationError::OtherMode(lost))
}

/// The share of the rows without a pose in the working mode.
fn lost_share(geometry: &Geometry<f64>, observed: &Observed<'_>, angles: [&Vec<f64>; 2]) -> f64 {
    let rows = angles[0].len();
    let every = (rows / 2000).max(1);
    let is_lost = |row: &usize| {
        let pose = geometry.forward(angles[0][*row], angles[1][*row], observed.assembly);
        !pose.is_ok_and(|pose| pose.working_mode() == observed.mode)
    };
    let lost = (0..rows).step_by(every).filter(is_lost).count();
    lost as f64 / rows.div_ceil(every) as f64
}
