//! Both `[[actuator]]`: reads them, and checks each by itself.

use super::actuator::Actuator;
use super::actuator_file::ActuatorFile;
use super::can_torque::check_can_drive;
use super::drive::{check_brake, check_transmission};
use super::hobby_servo::check_servo;
use super::stepper::check_stepper;
use super::value::{not_negative, positive, sized};
use crate::refusal::{Key, Refusal, Refusals};

/// The drives of joint 1 and joint 4; none for ideal torque sources.
pub(super) fn read_actuators(
    given: &[ActuatorFile],
    refusals: &mut Refusals,
) -> Result<Option<[Actuator; 2]>, Refusal> {
    if given.is_empty() {
        return Ok(None);
    }
    let given: &[ActuatorFile; 2] = refusals.noted(given.try_into().map_err(|_| {
        let count = given.len();
        let reason = format!("must be given twice, not {count}: joint 1 and joint 4");
        Key::Top("actuator").refused(reason)
    }))?;
    let actuators = [
        given[0].actuator(0, refusals),
        given[1].actuator(1, refusals),
    ];
    for (index, (a, file)) in actuators.iter().zip(given).enumerate() {
        if refusals.has_of("actuator", index) {
            continue;
        }
        let key = |name| Key::Of("actuator", index, name);
        if a.gear_ratio == 0.0 || !a.gear_ratio.is_finite() {
            let reason = format!(
                "must be finite and must not be 0 (negative if the motor turns against its joint), \
                 not {:?}",
                a.gear_ratio
            );
            refusals.add(key("gear_ratio"), reason);
        } else {
            refusals.note(sized(key("gear_ratio"), a.gear_ratio));
        }
        for (name, value) in [
            ("torque_constant", a.torque_constant),
            ("resistance", a.resistance),
            ("inductance", a.inductance),
            ("encoder_counts", f64::from(a.encoder_counts)),
            ("peak_current", a.peak_current),
            ("continuous_current", a.continuous_current),
            ("thermal_time_constant", a.thermal_time_constant),
            ("current_per_code", a.current_per_code.unwrap_or(1.0)),
        ] {
            // Of other kinds these are computed from keys that are checked under their own names.
            if file.gives(name) {
                refusals.note(positive(key(name), value));
            }
        }
        for (name, value) in [
            ("rotor_inertia", a.rotor_inertia),
            ("viscous_friction", a.viscous_friction),
            ("coulomb_friction", a.coulomb_friction),
            ("brake_torque", a.brake_torque),
        ] {
            refusals.note(not_negative(key(name), value));
        }
        check_stepper(index, a, refusals);
        check_can_drive(index, a, refusals);
        check_servo(index, a, refusals);
        refusals.note(check_brake(index, a));
        if !refusals.has_of("actuator", index) {
            refusals.note(check_transmission(index, a));
        }
    }
    Ok(Some(actuators))
}
