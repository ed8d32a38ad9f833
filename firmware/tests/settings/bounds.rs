//! A bound of the settings holds for either joint by itself, and the bound itself is allowed.

use crate::rig::settings;
use fivebar_firmware::Settings;
use fivebar_firmware::settings::{AxisField, BoardLimits, Field, HomingMethod, SettingsError};

type Change = fn(&mut Settings);

/// Gives a joint this value.
type Put = fn(&mut Settings, usize, f32);

fn result(change: impl FnOnce(&mut Settings)) -> Option<SettingsError> {
    let mut settings = settings();
    change(&mut settings);
    settings.check().err()
}

#[test]
fn a_limit_of_both_joints_is_compared_with_each() {
    for joint in 0..2 {
        let cases: [(f32, Put, Field); 4] = [
            (
                0.69,
                |s, joint, v| s.axes[joint].max_speed = v,
                Field::HomingSpeed,
            ),
            (
                1.19,
                |s, joint, v| {
                    s.axes[joint].peak_current = v;
                    s.axes[joint].continuous_current = 0.5;
                },
                Field::HomingCurrent,
            ),
            (
                50.5,
                |s, joint, v| s.axes[joint].max_speed = v,
                Field::OverSpeed,
            ),
            (
                6.05,
                |s, joint, v| s.axes[joint].peak_current = v,
                Field::OverCurrent,
            ),
        ];
        for (value, change, field) in cases {
            let refused = result(|s| change(s, joint, value));
            assert_eq!(refused, Some(SettingsError::Field(field)), "{joint}");
        }
    }
}

#[test]
fn either_joint_is_checked_by_its_number() {
    for (joint, number) in [(0, 1), (1, 4)] {
        let refused = result(|s| s.axes[joint].resistance = 0.0);
        let expected = SettingsError::Axis(number, AxisField::Resistance);
        assert_eq!(refused, Some(expected));
    }
}

#[test]
fn a_value_at_its_bound_is_allowed() {
    let cases: [Change; 25] = [
        |s| s.advanced.disarm_timeout = 1.0,
        |s| s.advanced.disarm_timeout = 86_400.0,
        |s| s.advanced.motion_torque = 0.01,
        |s| s.advanced.motion_torque = 1.0,
        |s| s.advanced.pen_friction = 0.0,
        |s| s.advanced.pen_friction = 10.0,
        |s| s.control.tick_rate = 50_000.0,
        |s| s.control.current_bandwidth = 0.35 * s.control.tick_rate,
        |s| s.control.bandwidth = 0.25 * s.control.current_bandwidth,
        |s| s.control.damping = 0.2,
        |s| s.control.damping = 2.0,
        |s| s.control.integral_rate = 0.25 * s.control.bandwidth,
        |s| s.control.observer_bandwidth = 2.0 * s.control.bandwidth,
        |s| s.homing.current = s.axes[0].peak_current,
        |s| s.protection.over_speed = s.axes[0].max_speed,
        |s| s.protection.over_current = s.axes[0].peak_current,
        |s| s.protection.command_timeout = 60.0,
        |s| s.motion.corner_tolerance = 0.0,
        |s| s.axes[0].thermal_time_constant = 3600.0,
        |s| s.axes[1].thermal_time_constant = 0.1,
        |s| s.protection.over_speed = 100.0 * s.axes[0].max_speed,
        |s| {
            s.axes
                .iter_mut()
                .for_each(|axis| axis.current_per_code = 0.01);
            s.protection.over_current = 5.0 * s.axes[0].peak_current;
        },
        // The trip point is that of the faster and of the stronger joint.
        |s| s.axes[0].max_speed = 1.0,
        |s| s.axes[1].resistance = s.protection.bus_voltage[1],
        |s| s.protection.bus_voltage = [0.8, 40.0],
    ];
    for (number, change) in cases.into_iter().enumerate() {
        assert_eq!(result(change), None, "case {number}");
    }
}

#[test]
fn a_value_just_beyond_its_bound_is_refused() {
    let cases: [(Change, Field); 26] = [
        (|s| s.advanced.motion_torque = 0.009, Field::MotionTorque),
        (|s| s.advanced.motion_torque = 1.01, Field::MotionTorque),
        (|s| s.advanced.pen_friction = -0.01, Field::PenFriction),
        (|s| s.advanced.pen_friction = 10.1, Field::PenFriction),
        (|s| s.advanced.disarm_timeout = 0.99, Field::DisarmTimeout),
        (
            |s| s.advanced.disarm_timeout = 86_401.0,
            Field::DisarmTimeout,
        ),
        (
            |s| s.advanced.disarm_timeout = f32::NAN,
            Field::DisarmTimeout,
        ),
        (|s| s.control.tick_rate = 50_001.0, Field::TickRate),
        (
            |s| s.control.current_bandwidth = 0.0,
            Field::CurrentBandwidth,
        ),
        (|s| s.control.bandwidth = 0.0, Field::Bandwidth),
        (|s| s.control.damping = 2.01, Field::Damping),
        (
            |s| s.control.observer_bandwidth = 1.01 * s.control.tick_rate,
            Field::ObserverBandwidth,
        ),
        (|s| s.homing.speed = 0.0, Field::HomingSpeed),
        (|s| s.homing.speed = f32::NAN, Field::HomingSpeed),
        (|s| s.homing.back_off = 1.0, Field::HomingBackOff),
        (|s| s.homing.back_off = f32::NAN, Field::HomingBackOff),
        (|s| s.homing.current = 0.0, Field::HomingCurrent),
        (|s| s.homing.current = f32::NAN, Field::HomingCurrent),
        (
            |s| s.protection.following_error = 0.0,
            Field::FollowingError,
        ),
        (
            |s| s.protection.over_speed = f32::INFINITY,
            Field::OverSpeed,
        ),
        (|s| s.protection.over_current = f32::NAN, Field::OverCurrent),
        (
            |s| s.protection.bus_voltage = [0.0, 30.0],
            Field::BusVoltage,
        ),
        (
            |s| s.protection.bus_voltage = [0.79, 40.0],
            Field::BusVoltage,
        ),
        (
            |s| s.protection.over_speed = 100.1 * s.axes[0].max_speed,
            Field::OverSpeed,
        ),
        (
            |s| {
                s.axes
                    .iter_mut()
                    .for_each(|axis| axis.current_per_code = 0.01);
                s.protection.over_current = 5.01 * s.axes[0].peak_current;
            },
            Field::OverCurrent,
        ),
        (
            |s| s.protection.command_timeout = 60.1,
            Field::CommandTimeout,
        ),
    ];
    for (number, (change, field)) in cases.into_iter().enumerate() {
        let refused = result(change);
        assert_eq!(refused, Some(SettingsError::Field(field)), "case {number}");
    }
}

/// With a jerk of j, a stop from the speed v takes √(6 v/j) at least.
#[test]
fn a_jerk_with_which_a_stop_takes_more_than_ten_seconds_is_refused() {
    for speed in [0.05, 0.5] {
        let with_jerk = |share: f32| {
            result(|settings| {
                settings.motion.max_speed = speed;
                settings.motion.max_jerk = share * 0.06 * speed;
            })
        };
        assert_eq!(with_jerk(1.001), None, "{speed} m/s");
        let refused = Some(SettingsError::Field(Field::MaxJerk));
        assert_eq!(with_jerk(0.999), refused, "{speed} m/s");
    }
}

#[test]
fn the_count_rate_of_either_encoder_is_within_the_board_s() {
    let limits = BoardLimits::STM32F405;
    assert_eq!(limits.check(&settings()), Ok(()));
    for joint in 0..2 {
        let mut fine = settings();
        fine.axes[joint].encoder_counts *= 3;
        let refused = SettingsError::BoardCountRate(limits.count_rate);
        assert_eq!(limits.check(&fine), Err(refused), "joint {joint}");
        // The sense of the gear does not matter.
        fine.axes[joint].gear_ratio = -fine.axes[joint].gear_ratio;
        assert_eq!(limits.check(&fine), Err(refused), "joint {joint}");
    }
}

#[test]
fn absolute_encoders_are_refused_on_a_board_whose_counters_start_at_0() {
    let mut absolute = settings();
    absolute.home_reference.method = HomingMethod::Absolute;
    let mut limits = BoardLimits::STM32F405;
    assert_eq!(limits.check(&absolute), Err(SettingsError::BoardEncoders));
    limits.absolute_encoders = true;
    assert_eq!(limits.check(&absolute), Ok(()));
}

#[test]
fn an_arm_whose_inertia_has_no_number_is_refused() {
    let refused = result(|settings| {
        settings.payload = f32::MAX;
        for link in &mut settings.links {
            link.mass = f32::MAX;
        }
    });
    assert_eq!(refused, Some(SettingsError::NoPose));
}

#[test]
fn an_encoders_error_may_be_large_and_must_change_slowly() {
    let table = |points: [i16; 3]| {
        result(|settings| {
            let [table, _] = &mut settings.encoder_tables;
            table.shaft_ratio = 10.0;
            table.points = [[points[0]; 16]; 4];
            table.points[2][7..9].copy_from_slice(&points[1..]);
        })
    };
    assert_eq!(table([5000, 5000, 5000]), None);
    assert_eq!(table([-300, 772, 772]), None);
    assert!(table([-300, 773, 773]).is_some());
    assert!(table([-300, -1373, -1373]).is_some());
}

#[test]
fn a_reversed_gear_has_the_bounds_of_the_same_gear_forward() {
    for ratio in [8.0, -8.0] {
        let refused = result(|s| {
            s.axes[1].gear_ratio = ratio;
            s.axes[1].encoder_counts = 600_000;
        });
        let expected = SettingsError::Axis(4, AxisField::EncoderCounts);
        assert_eq!(refused, Some(expected), "{ratio}");
    }
}

/// A value wrong by a thousand that would disable a protection.
#[test]
fn a_protection_that_protects_nothing_is_refused() {
    let cases: [(Change, AxisField); 4] = [
        (
            |s| s.axes[0].thermal_time_constant = 12_000.0,
            AxisField::ThermalTimeConstant,
        ),
        (
            |s| s.axes[1].thermal_time_constant = 0.012,
            AxisField::ThermalTimeConstant,
        ),
        // The sensors and the trip point follow the peak current.
        (
            |s| {
                for axis in &mut s.axes {
                    axis.peak_current *= 1000.0;
                    axis.current_per_code *= 1000.0;
                }
                s.protection.over_current *= 1000.0;
            },
            AxisField::PeakCurrent,
        ),
        (
            |s| s.axes.iter_mut().for_each(|axis| axis.resistance *= 1000.0),
            AxisField::PeakCurrent,
        ),
    ];
    for (number, (change, field)) in cases.into_iter().enumerate() {
        let refused = result(change);
        let named = matches!(refused, Some(SettingsError::Axis(_, found)) if found == field);
        assert!(named, "case {number}: {refused:?}");
    }
}
