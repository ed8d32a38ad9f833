//! An identification as text.

use super::quantity;
use crate::study::identification::Validations;
use fivebar_design::identification::{BASE_NAMES, Identification, Payload};
use fivebar_kinematics::five_bar::Joint;
use std::fmt::Write as _;

/// Base parameters, friction and offsets with their deviations, and what stays unexplained.
pub fn identification(name: &str, rows: usize, found: &Identification) -> String {
    let mut text = format!("{name}, {rows} rows\n");
    for (index, name) in BASE_NAMES.iter().enumerate().take(found.base.len()) {
        let unit = if name.starts_with('J') {
            "kg·m²"
        } else {
            "kg·m"
        };
        let _ = writeln!(
            text,
            "  {:<4} {:>12.4e} {unit:<5} ± {:.1e}",
            format!("{name}*"),
            found.base[index],
            found.base_sd[index]
        );
    }
    for joint in Joint::ALL {
        let with_sd = |values: [f64; 2], sd: [f64; 2], unit: &str| {
            format!(
                "{} ± {}",
                quantity(values[joint], unit),
                quantity(sd[joint], unit)
            )
        };
        let _ = writeln!(
            text,
            "  {joint}: viscous friction {}, Coulomb friction {}, torque offset {}",
            with_sd(found.viscous, found.viscous_sd, "N·m·s/rad"),
            with_sd(found.coulomb, found.coulomb_sd, "N·m"),
            with_sd(found.offset, found.offset_sd, "N·m"),
        );
        let _ = writeln!(
            text,
            "           {} RMS of its torque is not explained, {:.2} %",
            quantity(found.residual_rms[joint], "N·m"),
            1e2 * found.residual_share[joint]
        );
        if found.left_out[joint] > 0.0 {
            let _ = writeln!(
                text,
                "           {:.1} % of the log is left out, because wrong currents spoil it",
                1e2 * found.left_out[joint]
            );
        }
    }
    let _ = writeln!(text, "  condition {:.1}", found.condition);
    text
}

/// How well a second log's torques are predicted.
pub fn validation(found: &Validations) -> String {
    let error = |rms: f64| {
        let share = 1e2 * rms / found.after.torque_rms;
        format!("{} RMS, {share:.2} %", quantity(rms, "N·m"))
    };
    let mut text = format!(
        "  the second log's torques of {} RMS are predicted to {}",
        quantity(found.after.torque_rms, "N·m"),
        error(found.after.rms)
    );
    if let Some(before) = found.before {
        let _ = write!(text, "; by the robot file to {}", error(before.rms));
    }
    text + "\n"
}

/// A payload.
pub fn payload(name: &str, rows: usize, found: &Payload) -> String {
    let [first, fourth] = found.residual_rms.map(|rms| quantity(rms, "N·m"));
    format!(
        "{name}, {rows} rows\n  payload {:.2} ± {:.2} g, as far as the masses of the \
         robot file are right\n  not explained: {first} of joint 1's torque, \
         {fourth} of joint 4's, RMS\n",
        1e3 * found.mass,
        1e3 * found.sd
    )
}
