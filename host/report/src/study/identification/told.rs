//! From the torques that drives on a bus are told to the torques that act.
//!
//! A torque that is told in a tick is rounded to what a frame holds. It is at its drive a little later, and stays until the
//! next one comes. The drive's current loop follows it as a first order with the lag T, dτ/dt = (τd − τ)/T. Angles are as old
//! as their answers, those of each joint differently; here they become those of one moment.
//!
//! A drive looks at what it is told at the next turn of its loops: by chance, because its clock is its own.

use fivebar_design::identification::Identification;
use fivebar_files::robot::Robot;
use fivebar_firmware::drives::can::{Protocol, sensed_after, told_after};
use fivebar_kinematics::five_bar::Joint;

/// Half of the time between two turns of a drive's loops [s]: that long a torque waits in the mean until its drive looks.
const WAIT: f64 = 0.5 * 125e-6;

/// By this factor the deviations of a log are wider: what a drive tells errs at the same places of the motion again, and its
/// loops turn at other times of a tick, which the residuals show too small. The factors hold 95 % of the values of simulated
/// arms within their intervals.
fn widening(protocol: &Protocol) -> f64 {
    match protocol {
        Protocol::Odrive => 1.6,
        Protocol::Mit(_) => 3.2,
    }
}

/// What was found with deviations that allow for drives on a bus, if the robot has them.
pub(super) fn widened(robot: &Robot, mut found: Identification) -> Identification {
    let Some((protocol, _)) = robot.can_bus() else {
        return found;
    };
    let factor = widening(&protocol);
    let pairs = [
        &mut found.viscous_sd,
        &mut found.coulomb_sd,
        &mut found.offset_sd,
    ];
    for sd in pairs.into_iter().flatten().chain(&mut found.base_sd) {
        *sd *= factor;
    }
    found
}

/// The rows of a log with the means of the torques that acted from the angles of the row before to those of each row, in
/// the place of the torques told in each row's tick; of a robot without drives on a bus, the same rows.
pub(super) fn acted(robot: &Robot, rows: &[[f64; 5]]) -> Vec<[f64; 5]> {
    let mut rows = rows.to_vec();
    let Some((protocol, drives)) = robot.can_bus() else {
        return rows;
    };
    let period = 1.0 / robot.control.tick_rate;
    let sensed = sensed_after(&protocol, drives.map(|drive| drive.node)).map(f64::from);
    let told = told_after(&protocol).map(f64::from);
    let moment = sensed[0].min(sensed[1]);
    for joint in Joint::ALL {
        let (angle, torque) = (1 + joint.index(), 3 + joint.index());
        let later = (sensed[joint] - moment) / period;
        let lag = drives[joint].lag;
        let delay = told[joint] + WAIT - moment;
        let ratio = drives[joint].gear_ratio;
        let held = |row: &[f64; 5]| {
            let at_shaft = (row[torque] / ratio) as f32;
            ratio * f64::from(protocol.torque_in_frame(at_shaft))
        };
        let torques: Vec<f64> = rows.iter().map(held).collect();
        let means = means(&torques, delay / period, lag / period);
        for (row, mean) in means.into_iter().enumerate().rev() {
            let before = rows[row.saturating_sub(1)][angle];
            rows[row][angle] -= later * (rows[row][angle] - before);
            rows[row][torque] = mean;
        }
    }
    rows
}

/// The means of a first order with this lag, row by row, of what is told in each row and comes so much later; times in rows.
///
/// Row k has the answer to what was told in row k − 1. So the mean of row k begins when the answer to row k − 2 does.
fn means(told: &[f64], delay: f64, lag: f64) -> Vec<f64> {
    let Some(&first) = told.first() else {
        return Vec::new();
    };
    let whole = delay.floor();
    let part = delay - whole;
    let at = |row: i64| told[row.clamp(0, told.len() as i64 - 1) as usize];
    let mut torque = first;
    let mean = |row: usize| {
        let older = row as i64 - 3 - whole as i64;
        let mut sum = 0.0;
        for (set_point, time) in [(at(older), part), (at(older + 1), 1.0 - part)] {
            let left = (-time / lag).exp();
            let gap = torque - set_point;
            sum += set_point * time + gap * lag * (1.0 - left);
            torque = set_point + gap * left;
        }
        sum
    };
    (0..told.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::means;

    #[test]
    fn a_step_comes_late_and_as_a_first_order() {
        let mut told = vec![0.0; 10];
        told[4..].fill(1.0);
        // A lag of nearly nothing: told in row 4, it comes a quarter of a row after the answer to row 4 begins.
        let found = means(&told, 0.25, 1e-9);
        for (row, wanted) in [(5, 0.0), (6, 0.75), (7, 1.0)] {
            assert!((found[row] - wanted).abs() < 1e-6, "{row}: {}", found[row]);
        }
        // It comes before that answer: half of it is in the row before.
        let found = means(&told, -0.5, 1e-9);
        assert!((found[5] - 0.5).abs() < 1e-6 && (found[6] - 1.0).abs() < 1e-6);
        // With a lag, what is missing of all rows is the lag.
        let found = means(&told, 0.0, 0.4);
        let missing: f64 = found[6..].iter().map(|mean| 1.0 - mean).sum();
        assert!((missing - 0.4).abs() < 1e-4, "{missing}");
        assert!(means(&[], 0.2, 0.4).is_empty());
    }
}
