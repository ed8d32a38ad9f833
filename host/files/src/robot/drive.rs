//! The drive of an `[[actuator]]`: checks its stiffness and what is known of its encoder, and gives
//! what plans need of it.

use super::value::{not_negative, positive};
use super::{Actuator, Robot};
use crate::refusal::{Key, Refusal};
use fivebar_design::time_optimal::PlannedDrive;
use fivebar_firmware::settings::{AxisField, Field, Row};
use fivebar_plant::{Bound, MismatchError, check_harmonics};

/// A bound of the controller.
fn bound(row: &Row) -> Bound {
    let [least, greatest] = row.range;
    Bound::Within(least, greatest, row.unit)
}

impl Robot {
    /// The joints' drives as plans of motion have them; ideal without `[[actuator]]`.
    pub fn planned_drives(&self) -> [PlannedDrive; 2] {
        self.actuators.map_or_else(Default::default, |actuators| {
            actuators.map(|actuator| PlannedDrive {
                viscous: actuator.viscous_friction,
                coulomb: actuator.coulomb_friction,
                torque_constant: match actuator.kind().is_limited_by_winding() {
                    true => actuator.torque_constant * actuator.gear_ratio.abs(),
                    false => 0.0,
                },
                resistance: actuator.resistance,
            })
        })
    }
}

/// Checks that a brake's times are those of a brake.
pub(super) fn check_brake(index: usize, actuator: &Actuator) -> Result<(), Refusal> {
    for (name, field, time) in [
        (
            "brake_engage_time",
            Field::BrakeEngageTime,
            actuator.brake_engage_time,
        ),
        (
            "brake_release_time",
            Field::BrakeReleaseTime,
            actuator.brake_release_time,
        ),
    ] {
        let (key, time) = (Key::Of("actuator", index, name), time.unwrap_or(0.0));
        bound(&field.row())
            .check(name, time)
            .map_err(|invalid| key.refused(invalid))?;
        if time > 0.0 && actuator.brake_torque <= 0.0 {
            let reason = "needs a `brake_torque`: without it the joint has no brake";
            return Err(key.refused(reason));
        }
    }
    Ok(())
}

pub(super) fn check_transmission(index: usize, actuator: &Actuator) -> Result<(), Refusal> {
    let key = |name| Key::Of("actuator", index, name);
    let refused = |invalid: MismatchError| key(invalid.name).refused(invalid);
    let latency = ("encoder_latency", actuator.encoder_latency);
    let damping = ("drive_damping", actuator.drive_damping);
    bound(&AxisField::EncoderLatency.row())
        .check(latency.0, latency.1)
        .map_err(refused)?;
    check_harmonics("encoder_error", &actuator.encoder_error).map_err(refused)?;
    not_negative(key(damping.0), damping.1)?;
    let Some(stiffness) = actuator.stiffness else {
        if damping.1 > 0.0 {
            return Err(refused(Bound::NoSpring.broken_by(damping.0, damping.1)));
        }
        return Ok(());
    };
    positive(key("stiffness"), stiffness)?;
    if actuator.rotor_inertia <= 0.0 {
        return Err(refused(Bound::NoRotor.broken_by("stiffness", stiffness)));
    }
    let motor = actuator.motor();
    Bound::TooStiff(motor.stiffest_drive())
        .check("stiffness", stiffness)
        .map_err(refused)?;
    Bound::Within(0.0, motor.most_drive_damping(), "N·m·s/rad")
        .check(damping.0, damping.1)
        .map_err(refused)
}
