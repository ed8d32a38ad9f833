//! Sections of the settings, mostly with one of their values changed.

use crate::bytes::Bytes;
use fivebar_firmware::Settings;
use fivebar_firmware::protocol::{Section, SectionKey};
use fivebar_firmware::settings::{HomingMethod, ToolOutputSettings};

/// Any key, also of a section that does not exist.
pub(crate) fn key(bytes: &mut Bytes<'_>) -> SectionKey {
    match bytes.byte() % 20 {
        18 => SectionKey::Link(bytes.byte()),
        19 => SectionKey::Axis(bytes.byte()),
        index => SectionKey::ALL[usize::from(index) % SectionKey::ALL.len()],
    }
}

/// A section of the settings in use, with one of its values changed or none.
#[expect(clippy::too_many_lines, reason = "a list: one arm for each section")]
pub(crate) fn section(bytes: &mut Bytes<'_>, settings: &Settings) -> Section {
    let Some(mut section) = key(bytes).of(settings) else {
        return Section::Payload(bytes.number(0.0, 0.1));
    };
    let which = bytes.byte();
    let change = |bytes: &mut Bytes<'_>, values: &mut [&mut f32]| {
        let index = usize::from(which) % (values.len() + 1);
        if let Some(value) = values.get_mut(index) {
            **value = match bytes.byte() {
                0..=7 => f32::from_bits(bytes.word()),
                8..=15 => -**value,
                _ => **value * bytes.within(0.5, 1.5),
            };
        }
    };
    match &mut section {
        Section::Lengths(lengths) => change(bytes, &mut lengths.each_mut()),
        Section::Link(_, link) => {
            let [along, aside] = &mut link.com;
            change(
                bytes,
                &mut [&mut link.mass, along, aside, &mut link.inertia],
            );
        }
        Section::Payload(payload) => change(bytes, &mut [payload]),
        Section::Gravity(pair) => *pair = bytes.pair(-10.0, 10.0),
        Section::ToolOffset(pair) => *pair = bytes.pair(-0.02, 0.02),
        Section::Elbows(elbows) => elbows[usize::from(which & 1)] ^= which & 2 == 0,
        Section::Assembly(left) => *left ^= which & 7 == 0,
        Section::Crossing(allowed) => *allowed ^= which & 1 == 0,
        Section::Brake(brake) => {
            let [engage_time, release_time] = bytes.pair(0.0, 0.05);
            (brake.engage_time, brake.release_time) = (engage_time, release_time);
        }
        Section::Belt(_, belt) => {
            belt.encoder_at_joint ^= which & 7 == 0;
            let [g1, g2, g3, g4, g5] = &mut belt.observer;
            change(
                bytes,
                &mut [
                    &mut belt.stiffness,
                    &mut belt.damping,
                    &mut belt.bandwidth,
                    &mut belt.damping_ratio,
                    &mut belt.rotor_damping,
                    g1,
                    g2,
                    g3,
                    g4,
                    g5,
                ],
            );
        }
        Section::FieldLag(_, lag) => {
            change(bytes, &mut [&mut lag.from, &mut lag.slope, &mut lag.bend]);
        }
        Section::Axis(_, axis) => {
            if which & 31 == 0 {
                axis.encoder_counts = bytes.word();
            }
            let [low, high] = &mut axis.angle_limits;
            change(
                bytes,
                &mut [
                    &mut axis.gear_ratio,
                    &mut axis.rotor_inertia,
                    &mut axis.torque_constant,
                    &mut axis.resistance,
                    &mut axis.inductance,
                    &mut axis.viscous_friction,
                    &mut axis.coulomb_friction,
                    &mut axis.encoder_latency,
                    &mut axis.home_angle,
                    low,
                    high,
                    &mut axis.max_speed,
                    &mut axis.max_acceleration,
                    &mut axis.peak_current,
                    &mut axis.continuous_current,
                    &mut axis.thermal_time_constant,
                    &mut axis.current_per_code,
                ],
            );
        }
        Section::Control(control) => {
            control.computed_torque = which & 7 != 0;
            change(
                bytes,
                &mut [
                    &mut control.tick_rate,
                    &mut control.bandwidth,
                    &mut control.damping,
                    &mut control.integral_rate,
                    &mut control.observer_bandwidth,
                    &mut control.current_bandwidth,
                    &mut control.friction_smoothing,
                ],
            );
        }
        Section::Motion(motion) => change(
            bytes,
            &mut [
                &mut motion.max_speed,
                &mut motion.max_acceleration,
                &mut motion.max_jerk,
                &mut motion.corner_tolerance,
                &mut motion.singularity_margin,
            ],
        ),
        Section::Protection(protection) => {
            let [low, high] = &mut protection.bus_voltage;
            change(
                bytes,
                &mut [
                    &mut protection.following_error,
                    &mut protection.over_speed,
                    &mut protection.over_current,
                    low,
                    high,
                    &mut protection.bus_voltage_per_code,
                    &mut protection.command_timeout,
                ],
            );
        }
        Section::ToolOutput(output) => *output = tool_output(which),
        Section::EncoderShaft(_, ratio) => change(bytes, &mut [ratio]),
        Section::EncoderPoints(_, points) => {
            points[usize::from(which) % 16] = i16::from_le_bytes([bytes.byte(), which]);
        }
        Section::Advanced(advanced) => change(bytes, &mut advanced.values_mut()),
        Section::Homing(homing) => change(
            bytes,
            &mut [&mut homing.speed, &mut homing.back_off, &mut homing.current],
        ),
        Section::HomeReference(reference) => {
            reference.samples = bytes.byte();
            reference.method = [
                HomingMethod::Switch,
                HomingMethod::HardStop,
                HomingMethod::Absolute,
                HomingMethod::Given,
                HomingMethod::Index,
            ][usize::from(which) % 5];
        }
    }
    section
}

/// The output for a tool, of any kind.
pub(crate) fn tool_output(which: u8) -> ToolOutputSettings {
    match which & 3 {
        0 => ToolOutputSettings::Servo {
            up_width: 1e-3,
            down_width: 2e-3,
            frame_rate: 50.0,
            down_time: 0.01,
            up_time: 0.005,
        },
        1 => ToolOutputSettings::Switch {
            active_low: which & 4 != 0,
            down_time: 0.0,
            up_time: 0.002,
        },
        2 => ToolOutputSettings::Power {
            frequency: 1e4,
            scale_with_speed: which & 4 != 0,
        },
        _ => ToolOutputSettings::None,
    }
}
