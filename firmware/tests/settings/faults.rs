//! Everything that is wrong with settings is named at once, and the table says how.

use crate::rig::{settings, with};
use fivebar_firmware::Settings;
use fivebar_firmware::settings::{AxisField, Field, SettingsError, rows};
use fivebar_kinematics::dynamics::ModelError;

type Change = fn(&mut Settings);

fn named(change: impl FnOnce(&mut Settings)) -> Vec<SettingsError> {
    let settings = with(change);
    let faults = settings.faults();
    // The check names the first of them.
    assert_eq!(settings.check().err(), faults.first().copied());
    faults.to_vec()
}

#[test]
fn valid_settings_have_no_faults() {
    assert_eq!(settings().faults().len(), 0);
}

#[test]
fn three_faults_get_three_answers() {
    let found = named(|s| {
        s.axes[0].inductance = -1.0;
        s.control.damping = f32::NAN;
        s.protection.command_timeout = 61.0;
    });
    let expected = [
        SettingsError::Axis(1, AxisField::Inductance),
        SettingsError::Field(Field::Damping),
        SettingsError::Field(Field::CommandTimeout),
    ];
    assert_eq!(found, expected);
    let found = named(|s| {
        s.links[1].mass = -1.0;
        s.axes[1].angle_limits = [2.0, 1.0];
        s.motion.max_jerk = 0.0;
    });
    let expected = [
        SettingsError::Axis(4, AxisField::AngleLimits),
        SettingsError::Field(Field::MaxJerk),
        SettingsError::Inertia(ModelError::Link(2)),
    ];
    assert_eq!(found, expected);
}

/// Each of these makes others wrong that are compared with it.
#[test]
fn what_follows_from_a_fault_is_not_named() {
    let cases: [(Change, SettingsError); 7] = [
        (
            |s| s.control.tick_rate = 99.0,
            SettingsError::Field(Field::TickRate),
        ),
        (
            |s| s.control.bandwidth = f32::NAN,
            SettingsError::Field(Field::Bandwidth),
        ),
        (
            |s| s.axes[1].max_speed = f32::NAN,
            SettingsError::Axis(4, AxisField::MaxSpeed),
        ),
        (
            |s| s.axes[0].peak_current = 1e6,
            SettingsError::Axis(1, AxisField::PeakCurrent),
        ),
        (
            |s| s.axes[0].resistance = 1e6,
            SettingsError::Axis(1, AxisField::Resistance),
        ),
        (
            |s| s.protection.bus_voltage = [-1.0, 0.1],
            SettingsError::Field(Field::BusVoltage),
        ),
        (
            |s| s.axes[0].rotor_inertia = -1.0,
            SettingsError::Axis(1, AxisField::RotorInertia),
        ),
    ];
    for (change, expected) in cases {
        assert_eq!(named(change), [expected]);
    }
}

#[test]
fn the_table_states_a_default_within_its_bounds_and_each_path_once() {
    let mut paths: Vec<_> = rows().map(|row| row.path).collect();
    let all = paths.len();
    paths.sort_unstable();
    paths.dedup();
    assert_eq!(paths.len(), all);
    for row in rows() {
        let [least, greatest] = row.range;
        assert!(!row.meaning.is_empty(), "{}", row.path);
        if let Some(default) = row.default {
            assert!((least..=greatest).contains(&default), "{}", row.path);
        }
    }
}

/// As they were written by hand.
#[test]
fn sentences_follow_from_the_table() {
    for (error, sentence) in [
        (
            SettingsError::Axis(1, AxisField::GearRatio),
            "joint 1: gear_ratio must be ±0.001 to ±10 000",
        ),
        (
            SettingsError::Axis(4, AxisField::ViscousFriction),
            "joint 4: viscous_friction must lie in 0 to 10 000 N·m·s/rad",
        ),
        (
            SettingsError::Axis(4, AxisField::AngleLimits),
            "joint 4: angle_limits must be rising and within ±2π [rad]",
        ),
        (
            SettingsError::Axis(1, AxisField::MaxAcceleration),
            "joint 1: max_acceleration must lie in 0.001 to 1e7 rad/s², and stop the joint from \
             max_speed within 10 s",
        ),
        (
            SettingsError::Axis(1, AxisField::EncoderCounts),
            "joint 1: encoder_counts must be positive, and at most 4 194 304 per turn of the joint",
        ),
        (
            SettingsError::Field(Field::HomingSamples),
            "home_reference.samples must be 1 to 255",
        ),
        (
            SettingsError::Field(Field::HomingBackOff),
            "homing.back_off must be positive and under 1 rad",
        ),
        (
            SettingsError::Field(Field::Bandwidth),
            "control.bandwidth must be positive and at most a quarter of current_bandwidth [rad/s]",
        ),
        (
            SettingsError::Field(Field::ToolFrequency),
            "tool_output.frequency must lie in 10 to 100 000 Hz",
        ),
    ] {
        assert_eq!(error.to_string(), sentence);
    }
}
