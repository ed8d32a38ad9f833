//! What settings the production image refuses: each field, and the board's bounds.

mod bench;

use bench::{Driven, settings};
use fivebar_firmware::Settings;
use fivebar_firmware::protocol::{CommandError, SectionKey};

/// Changes of which each makes the settings invalid.
const BROKEN: &[fn(&mut Settings)] = &[
    |s| s.lengths[0] = -1.0,
    |s| s.lengths[4] = 1.0,
    |s| s.links[1].mass = f32::NAN,
    |s| s.links[3].inertia = -1.0,
    |s| s.payload = -1.0,
    |s| s.gravity = [f32::INFINITY, 0.0],
    |s| s.tool_offset = [f32::NAN, 0.0],
    |s| s.elbows_left = [true, false],
    |s| s.control.tick_rate = 0.0,
    // Valid on another board: this one has one rate, and filters at its encoders.
    |s| s.control.tick_rate = 20_000.0,
    |s| s.protection.over_speed = 75.0,
    |s| s.control.bandwidth = -3.0,
    |s| s.control.damping = 0.1,
    |s| s.control.integral_rate = 1e3,
    |s| s.control.observer_bandwidth = 1.0,
    |s| s.control.current_bandwidth = 1e5,
    |s| s.control.friction_smoothing = 0.0,
    |s| s.protection.bus_voltage = [30.0, 20.0],
    |s| s.protection.bus_voltage_per_code = 0.0,
    |s| s.protection.following_error = 1.0,
    |s| s.protection.over_speed = 1.0,
    |s| s.protection.over_current = 1.0,
    |s| s.protection.command_timeout = 0.0,
    |s| s.axes[0].encoder_counts = 0,
    |s| s.axes[0].gear_ratio = 0.0,
    |s| s.axes[1].gear_ratio = f32::NAN,
    |s| s.axes[1].rotor_inertia = -1.0,
    |s| s.axes[1].torque_constant = 0.0,
    |s| s.axes[1].resistance = -1.0,
    |s| s.axes[1].inductance = 0.0,
    |s| s.axes[1].viscous_friction = -1.0,
    |s| s.axes[1].coulomb_friction = f32::INFINITY,
    |s| s.axes[1].home_angle = 7.0,
    |s| s.axes[1].angle_limits = [2.0, 1.0],
    |s| s.axes[1].angle_limits = [-7.0, 1.0],
    |s| s.axes[1].max_speed = 0.0,
    |s| s.axes[1].max_acceleration = -1.0,
    |s| s.axes[1].peak_current = 0.0,
    |s| s.axes[1].continuous_current = 9.0,
    |s| s.axes[1].thermal_time_constant = 0.0,
    |s| s.axes[1].current_per_code = f32::NAN,
    |s| s.homing.speed = 0.0,
    |s| s.homing.back_off = 0.0,
    |s| s.homing.current = 9.0,
    |s| s.motion.max_speed = f32::NAN,
    |s| s.motion.max_acceleration = 0.0,
    |s| s.motion.max_jerk = -1.0,
    |s| s.motion.corner_tolerance = -1.0,
    |s| s.motion.singularity_margin = -1.0,
];

#[test]
fn every_section_is_checked_as_a_whole() {
    let mut driven = Driven::new();
    for (number, change) in BROKEN.iter().enumerate() {
        let mut settings = settings();
        change(&mut settings);
        let refused = driven.client.write_settings(&settings).expect("a line");
        assert_eq!(refused, Err(CommandError::Settings), "change {number}");
    }
    // The draft is complete again, and what is in use has never changed.
    let mut found = settings();
    driven.client.read_settings(&mut found).expect("settings");
    let differ = |key: &&SectionKey| key.of(&found) != key.of(&settings());
    assert_eq!(SectionKey::ALL.iter().find(differ), None);
    let applied = driven.client.write_settings(&settings()).expect("a line");
    assert_eq!(applied, Ok(()));
}

#[test]
fn every_section_is_read_back_as_it_was_written() {
    let mut written = settings();
    written.payload += 0.01;
    written.advanced.pen_friction = 0.25;
    written.motion.corner_tolerance *= 0.5;
    let mut driven = bench::Bench::with(
        fivebar_chip::Options::default(),
        Vec::new(),
        fivebar_chip::time::MILLISECOND,
    )
    .ready_as(&written);
    let mut read = Settings {
        payload: 0.0,
        ..settings()
    };
    driven
        .client
        .read_settings(&mut read)
        .expect("the sections");
    assert_eq!(read, written);
}
