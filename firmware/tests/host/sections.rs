//! Sections of the settings: random ones for property tests, and their places.

use crate::messages::{number, pair};
use fivebar_firmware::Settings;
use fivebar_firmware::protocol::{Section, SectionKey};
use fivebar_firmware::settings::{
    AdvancedSettings, AxisSettings, BeltSettings, BrakeSettings, ControlSettings, FieldLag,
    HomeReference, HomingMethod, HomingSettings, LinkSettings, MotionSettings, ProtectionSettings,
    ToolOutputSettings,
};
use proptest::prelude::*;

pub(crate) fn section_key() -> impl Strategy<Value = SectionKey> {
    prop_oneof![
        prop::sample::select(SectionKey::ALL.to_vec()),
        any::<u8>().prop_map(SectionKey::Link),
        any::<u8>().prop_map(SectionKey::Axis),
    ]
}

fn axis() -> impl Strategy<Value = AxisSettings> {
    (
        prop::array::uniform16(number()),
        any::<[u32; 2]>(),
        any::<u16>(),
        any::<bool>(),
    )
        .prop_map(
            |(v, [encoder_counts, index_counts], current_zero_code, home_forward)| AxisSettings {
                gear_ratio: v[0],
                rotor_inertia: v[1],
                torque_constant: v[2],
                resistance: v[3],
                inductance: v[4],
                viscous_friction: v[5],
                coulomb_friction: v[6],
                encoder_counts,
                index_counts,
                encoder_latency: v[6] * 0.5,
                home_angle: v[7],
                home_forward,
                angle_limits: [v[8], v[9]],
                max_speed: v[10],
                max_acceleration: v[11],
                peak_current: v[12],
                continuous_current: v[13],
                thermal_time_constant: v[14],
                current_per_code: v[15],
                current_zero_code,
            },
        )
}

/// Any section.
#[expect(clippy::too_many_lines, reason = "a list of cases")]
pub(crate) fn section() -> impl Strategy<Value = Section> {
    prop_oneof![
        prop::array::uniform5(number()).prop_map(Section::Lengths),
        (any::<u8>(), number(), pair(), number()).prop_map(|(index, mass, com, inertia)| {
            Section::Link(index, LinkSettings { mass, com, inertia })
        }),
        number().prop_map(Section::Payload),
        pair().prop_map(Section::Gravity),
        pair().prop_map(Section::ToolOffset),
        any::<[bool; 2]>().prop_map(Section::Elbows),
        (any::<u8>(), axis()).prop_map(|(index, axis)| Section::Axis(index, axis)),
        (prop::array::uniform7(number()), any::<bool>()).prop_map(|(v, computed_torque)| {
            Section::Control(ControlSettings {
                tick_rate: v[0],
                bandwidth: v[1],
                damping: v[2],
                integral_rate: v[3],
                observer_bandwidth: v[4],
                current_bandwidth: v[5],
                friction_smoothing: v[6],
                computed_torque,
            })
        }),
        prop::array::uniform5(number()).prop_map(|v| {
            Section::Motion(MotionSettings {
                max_speed: v[0],
                max_acceleration: v[1],
                max_jerk: v[2],
                corner_tolerance: v[3],
                singularity_margin: v[4],
            })
        }),
        prop::array::uniform7(number()).prop_map(|v| {
            Section::Protection(ProtectionSettings {
                following_error: v[0],
                over_speed: v[1],
                over_current: v[2],
                bus_voltage: [v[3], v[4]],
                bus_voltage_per_code: v[5],
                command_timeout: v[6],
            })
        }),
        any::<bool>().prop_map(Section::Assembly),
        prop::array::uniform3(number()).prop_map(|v| {
            Section::Homing(HomingSettings {
                speed: v[0],
                back_off: v[1],
                current: v[2],
            })
        }),
        tool_output().prop_map(Section::ToolOutput),
        (home_method(), any::<u8>()).prop_map(|(method, samples)| {
            Section::HomeReference(HomeReference { method, samples })
        }),
        (any::<u8>(), number()).prop_map(|(index, ratio)| Section::EncoderShaft(index, ratio)),
        (any::<u8>(), prop::array::uniform16(any::<i16>()))
            .prop_map(|(index, points)| Section::EncoderPoints(index, points)),
        any::<bool>().prop_map(Section::Crossing),
        number().prop_map(|value| {
            let mut advanced = AdvancedSettings::DEFAULT;
            for number in advanced.values_mut() {
                *number = value;
            }
            Section::Advanced(advanced)
        }),
        (any::<u8>(), prop::array::uniform10(number()), any::<bool>()).prop_map(
            |(
                index,
                [
                    stiffness,
                    damping,
                    bandwidth,
                    damping_ratio,
                    rotor_damping,
                    observer @ ..,
                ],
                encoder_at_joint,
            )| {
                Section::Belt(
                    index,
                    BeltSettings {
                        stiffness,
                        damping,
                        encoder_at_joint,
                        bandwidth,
                        damping_ratio,
                        rotor_damping,
                        observer,
                    },
                )
            },
        ),
        (any::<u8>(), prop::array::uniform3(number())).prop_map(|(index, [from, slope, bend])| {
            Section::FieldLag(index, FieldLag { from, slope, bend })
        }),
        pair().prop_map(|[engage_time, release_time]| {
            Section::Brake(BrakeSettings {
                engage_time,
                release_time,
            })
        }),
    ]
}

fn home_method() -> impl Strategy<Value = HomingMethod> {
    prop_oneof![
        Just(HomingMethod::Switch),
        Just(HomingMethod::HardStop),
        Just(HomingMethod::Absolute),
        Just(HomingMethod::Given),
        Just(HomingMethod::Index),
    ]
}

fn tool_output() -> impl Strategy<Value = ToolOutputSettings> {
    prop_oneof![
        Just(ToolOutputSettings::None),
        prop::array::uniform5(number()).prop_map(|v| ToolOutputSettings::Servo {
            up_width: v[0],
            down_width: v[1],
            frame_rate: v[2],
            down_time: v[3],
            up_time: v[4],
        }),
        (any::<bool>(), pair()).prop_map(|(active_low, v)| ToolOutputSettings::Switch {
            active_low,
            down_time: v[0],
            up_time: v[1],
        }),
        (number(), any::<bool>()).prop_map(|(frequency, scale_with_speed)| {
            ToolOutputSettings::Power {
                frequency,
                scale_with_speed,
            }
        }),
    ]
}

#[test]
fn each_quarter_of_an_encoders_table_has_its_own_place() {
    let points = |index: u8| [i16::from(index) + 1; 16];
    let mut settings = Settings::BENCHTOP;
    for index in 0..8 {
        let section = Section::EncoderPoints(index, points(index));
        assert_eq!(section.put(&mut settings), Some(()));
    }
    for index in 0..8 {
        let section = SectionKey::EncoderPoints(index).of(&settings);
        assert_eq!(section, Some(Section::EncoderPoints(index, points(index))));
        let table = settings.encoder_tables[usize::from(index / 4)];
        assert_eq!(table.points[usize::from(index % 4)], points(index));
    }
    assert_eq!(SectionKey::EncoderPoints(8).of(&settings), None);
    assert_eq!(
        Section::EncoderPoints(8, points(8)).put(&mut settings),
        None
    );
}
