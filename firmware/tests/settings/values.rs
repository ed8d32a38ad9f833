//! Invalid settings are refused with the name of the invalid field.

use crate::rig::settings;
use fivebar_firmware::Settings;
use fivebar_firmware::settings::{AxisField, BoardLimits, Field, SettingsError};
use fivebar_kinematics::dynamics::ModelError;
use fivebar_kinematics::five_bar::GeometryError;

type Change = fn(&mut Settings);

#[track_caller]
fn refused(change: Change, error: SettingsError) {
    let mut settings = settings();
    change(&mut settings);
    assert_eq!(settings.check().err(), Some(error));
}

#[test]
fn the_benchtop_arm_is_accepted() {
    let checked = settings().check().expect("valid settings");
    assert_eq!(*checked, settings());
}

#[test]
fn the_longest_stored_copy_fits_its_buffer() {
    let mut longest = settings();
    // Small numbers take fewer bytes.
    for axis in &mut longest.axes {
        axis.encoder_counts = u32::MAX;
    }
    for points in longest
        .encoder_tables
        .iter_mut()
        .flat_map(|table| &mut table.points)
    {
        points.fill(i16::MIN);
    }
    // 1024 bytes, some of which its number and the log's headers take.
    let mut buffer = [0; 960];
    let stored = postcard::to_slice(&longest, &mut buffer).unwrap();
    assert_eq!(postcard::from_bytes::<Settings>(stored).unwrap(), longest);
}

#[test]
#[expect(clippy::too_many_lines, reason = "a list of cases")]
fn each_field_of_an_axis_is_checked() {
    let cases: [(Change, AxisField); 29] = [
        (|s| s.axes[1].gear_ratio = 0.0, AxisField::GearRatio),
        (|s| s.axes[1].gear_ratio = f32::NAN, AxisField::GearRatio),
        (|s| s.axes[1].rotor_inertia = -1e-9, AxisField::RotorInertia),
        (
            |s| s.axes[1].torque_constant = 0.0,
            AxisField::TorqueConstant,
        ),
        (|s| s.axes[1].resistance = -1.0, AxisField::Resistance),
        (|s| s.axes[1].inductance = 0.0, AxisField::Inductance),
        (
            |s| s.axes[1].viscous_friction = -1e-3,
            AxisField::ViscousFriction,
        ),
        (
            |s| s.axes[1].coulomb_friction = f32::INFINITY,
            AxisField::CoulombFriction,
        ),
        (
            |s| s.encoder_tables[1].shaft_ratio = f32::NAN,
            AxisField::EncoderTable,
        ),
        (
            |s| s.encoder_tables[1].shaft_ratio = 2e4,
            AxisField::EncoderTable,
        ),
        (
            |s| {
                s.encoder_tables[1].shaft_ratio = -10.0;
                s.encoder_tables[1].points[3][15] = -1073;
            },
            AxisField::EncoderTable,
        ),
        (|s| s.axes[1].encoder_counts = 0, AxisField::EncoderCounts),
        (
            |s| s.axes[1].encoder_counts = 1 << 20,
            AxisField::EncoderCounts,
        ),
        (|s| s.axes[1].home_angle = 7.0, AxisField::HomeAngle),
        (|s| s.axes[1].home_angle = f32::NAN, AxisField::HomeAngle),
        (
            |s| s.axes[1].angle_limits = [1.0, 1.0],
            AxisField::AngleLimits,
        ),
        (
            |s| s.axes[1].angle_limits = [-7.0, 1.0],
            AxisField::AngleLimits,
        ),
        (
            |s| s.axes[1].angle_limits = [f32::NAN, 1.0],
            AxisField::AngleLimits,
        ),
        (|s| s.axes[1].max_speed = 0.0, AxisField::MaxSpeed),
        (
            |s| s.axes[1].max_acceleration = f32::INFINITY,
            AxisField::MaxAcceleration,
        ),
        (|s| s.axes[1].peak_current = 0.0, AxisField::PeakCurrent),
        (
            |s| s.axes[1].continuous_current = 4.1,
            AxisField::ContinuousCurrent,
        ),
        (
            |s| s.axes[1].continuous_current = 0.0,
            AxisField::ContinuousCurrent,
        ),
        (
            |s| s.axes[1].thermal_time_constant = 0.0,
            AxisField::ThermalTimeConstant,
        ),
        (
            |s| s.axes[1].thermal_time_constant = f32::NAN,
            AxisField::ThermalTimeConstant,
        ),
        (
            |s| s.axes[1].current_per_code = 0.0,
            AxisField::CurrentPerCode,
        ),
        (
            |s| s.axes[1].current_per_code = -0.1,
            AxisField::CurrentPerCode,
        ),
        (|s| s.axes[1].max_speed = f32::NAN, AxisField::MaxSpeed),
        (
            |s| s.axes[1].peak_current = f32::NAN,
            AxisField::PeakCurrent,
        ),
    ];
    for (change, field) in cases {
        refused(change, SettingsError::Axis(4, field));
    }
}

#[test]
fn each_other_field_is_checked() {
    let cases: [(Change, Field); 27] = [
        (|s| s.tool_offset = [f32::NAN, 0.0], Field::ToolOffset),
        (|s| s.control.tick_rate = 0.0, Field::TickRate),
        (|s| s.control.tick_rate = f32::NAN, Field::TickRate),
        (
            |s| s.control.current_bandwidth = 3600.0,
            Field::CurrentBandwidth,
        ),
        (|s| s.control.bandwidth = 900.0, Field::Bandwidth),
        (|s| s.control.damping = 0.0, Field::Damping),
        (|s| s.control.integral_rate = 101.0, Field::IntegralRate),
        (|s| s.control.integral_rate = -1.0, Field::IntegralRate),
        (
            |s| s.control.observer_bandwidth = 400.0,
            Field::ObserverBandwidth,
        ),
        (
            |s| s.control.friction_smoothing = 0.0,
            Field::FrictionSmoothing,
        ),
        (|s| s.homing.speed = 36.0, Field::HomingSpeed),
        (|s| s.homing.back_off = 0.0, Field::HomingBackOff),
        (|s| s.homing.current = 5.0, Field::HomingCurrent),
        (|s| s.motion.max_speed = f32::NAN, Field::MaxSpeed),
        (|s| s.motion.max_acceleration = 0.0, Field::MaxAcceleration),
        // Stops that take more than 10 s.
        (
            |s| s.motion.max_acceleration = 0.14 * s.motion.max_speed,
            Field::MaxAcceleration,
        ),
        (|s| s.motion.max_jerk = -1.0, Field::MaxJerk),
        (
            |s| s.motion.max_jerk = 0.059 * s.motion.max_speed,
            Field::MaxJerk,
        ),
        (
            |s| s.motion.corner_tolerance = -1e-6,
            Field::CornerTolerance,
        ),
        (
            |s| s.motion.singularity_margin = 1.0,
            Field::SingularityMargin,
        ),
        (
            |s| s.motion.singularity_margin = 0.0,
            Field::SingularityMargin,
        ),
        (
            |s| s.protection.following_error = 1.0,
            Field::FollowingError,
        ),
        (|s| s.protection.over_speed = 34.0, Field::OverSpeed),
        (|s| s.protection.over_current = 3.9, Field::OverCurrent),
        (
            |s| s.protection.bus_voltage = [30.0, 18.0],
            Field::BusVoltage,
        ),
        (
            |s| s.protection.bus_voltage_per_code = 0.0,
            Field::BusVoltagePerCode,
        ),
        (
            |s| s.protection.command_timeout = 0.0,
            Field::CommandTimeout,
        ),
    ];
    for (change, field) in cases {
        refused(change, SettingsError::Field(field));
    }
}

#[test]
fn an_arm_that_cannot_be_is_refused() {
    refused(
        |s| s.lengths[3] = -0.1,
        SettingsError::Geometry(GeometryError::NotPositive(3)),
    );
    refused(
        |s| s.lengths[4] = 1.0,
        SettingsError::Geometry(GeometryError::CannotAssemble),
    );
    refused(
        |s| s.tool_offset = [-0.16, 0.0],
        SettingsError::Geometry(GeometryError::ToolOffset),
    );
    refused(
        |s| s.links[2].mass = f32::NAN,
        SettingsError::Inertia(ModelError::Link(3)),
    );
    // With crossed elbows, the other branch is outside the joints' limits.
    refused(|s| s.elbows_left = [true, false], SettingsError::NoPose);
}

#[test]
fn every_refusal_reads_as_a_sentence_that_names_the_field() {
    let mut bad = settings();
    bad.axes[0].resistance = 0.0;
    let text = bad.check().unwrap_err().to_string();
    assert_eq!(text, "joint 1: resistance must lie in 1e-5 to 1e5 Ω");
    let mut bad = settings();
    bad.control.damping = 9.0;
    let text = bad.check().unwrap_err().to_string();
    assert_eq!(text, "control.damping must lie in 0.2 to 2");
}

#[test]
fn values_that_no_arm_has_are_refused_before_they_overflow() {
    for (change, field) in [
        (
            (|s| s.axes[0].torque_constant = 1e-42) as Change,
            AxisField::TorqueConstant,
        ),
        (|s| s.axes[0].gear_ratio = 1e30, AxisField::GearRatio),
        (|s| s.axes[0].resistance = 1e-30, AxisField::Resistance),
        (|s| s.axes[0].inductance = 1e9, AxisField::Inductance),
        (|s| s.axes[0].rotor_inertia = 1e9, AxisField::RotorInertia),
        (
            |s| s.axes[0].viscous_friction = 1e9,
            AxisField::ViscousFriction,
        ),
        (|s| s.axes[0].max_speed = 1e-20, AxisField::MaxSpeed),
        (
            |s| s.axes[0].max_acceleration = 1e-10,
            AxisField::MaxAcceleration,
        ),
        (
            |s| s.axes[0].max_acceleration = 0.14 * s.axes[0].max_speed,
            AxisField::MaxAcceleration,
        ),
        (|s| s.axes[0].peak_current = 1e20, AxisField::PeakCurrent),
        (
            |s| s.axes[0].thermal_time_constant = 1e30,
            AxisField::ThermalTimeConstant,
        ),
        (
            |s| s.axes[0].current_per_code = 1e9,
            AxisField::CurrentPerCode,
        ),
    ] {
        refused(change, SettingsError::Axis(1, field));
    }
}

#[test]
fn a_trip_point_that_the_converter_cannot_show_is_refused() {
    let mut at_the_end = settings();
    // The code of zero current is 2048: the least full scale is 2047 codes up.
    at_the_end.axes[0].current_per_code = at_the_end.protection.over_current / 2046.0;
    at_the_end.axes[1].current_per_code = at_the_end.axes[0].current_per_code;
    assert!(at_the_end.check().is_ok());
    refused(
        |s| s.axes[1].current_per_code = s.protection.over_current / 2046.5,
        SettingsError::Field(Field::OverCurrent),
    );
    refused(
        |s| s.axes[1].current_zero_code = 1000,
        SettingsError::Field(Field::OverCurrent),
    );
    refused(
        |s| s.axes[0].current_zero_code = 3200,
        SettingsError::Field(Field::OverCurrent),
    );
    refused(
        |s| s.protection.over_current = f32::INFINITY,
        SettingsError::Field(Field::OverCurrent),
    );
    refused(
        |s| s.protection.bus_voltage_per_code = s.protection.bus_voltage[1] / 4095.0,
        SettingsError::Field(Field::BusVoltagePerCode),
    );
}

#[test]
fn trip_points_beyond_what_the_boards_bridges_stand_are_refused() {
    let limits = BoardLimits::STM32F405;
    let [mut strong, mut high] = [settings(); 2];
    strong.protection.over_current = 6.0;
    high.protection.bus_voltage[1] = 36.0;
    assert_eq!(limits.check(&strong), Ok(()));
    assert_eq!(limits.check(&high), Ok(()));
    strong.protection.over_current = 6.01;
    high.protection.bus_voltage[1] = 36.1;
    for (settings, error, text) in [
        (
            strong,
            SettingsError::BoardCurrent(6),
            "protection.over_current must be at most 6 A",
        ),
        (
            high,
            SettingsError::BoardVoltage(36),
            "protection.bus_voltage must end at 36 V or below",
        ),
    ] {
        assert_eq!(limits.check(&settings), Err(error));
        assert!(error.to_string().contains(text), "{error}");
    }
}
