//! Every trip point by itself, for either joint and either sign, at its value and beyond it.

use super::Monitor;
use crate::Settings;
use core::f32::consts::TAU;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Geometry, Side};
use nalgebra::Vector2;

fn monitor_of(settings: &Settings) -> Monitor {
    Monitor::new(&settings.check().expect("valid settings"))
}

fn monitor() -> Monitor {
    monitor_of(&Settings::BENCHTOP)
}

/// Asserts that a value of either joint trips beyond ±`limit` only, and NaN does not.
#[track_caller]
fn trips_beyond(limit: f32, exceeded: impl Fn([f32; 2]) -> bool) {
    for sign in [1.0, -1.0] {
        let (at, beyond) = (sign * limit, sign * limit.next_up());
        assert!(!exceeded([at, at]), "both at {at}");
        assert!(exceeded([beyond, 0.0]), "joint 1 beyond {at}");
        assert!(exceeded([0.0, beyond]), "joint 4 beyond {at}");
        assert!(exceeded([2.0 * beyond, -2.0 * beyond]), "both beyond {at}");
    }
    assert!(!exceeded([f32::NAN; 2]), "not a number");
}

#[test]
fn the_speed_of_either_joint_trips_above_its_limit() {
    let limit = Settings::BENCHTOP.protection.over_speed;
    trips_beyond(limit, |velocity| monitor().over_speed(velocity));
}

#[test]
fn the_position_error_of_either_joint_trips_above_its_limit() {
    let limit = Settings::BENCHTOP.protection.following_error;
    trips_beyond(limit, |error| monitor().following_error_exceeded(error));
}

#[test]
fn an_innovation_beyond_the_angle_of_a_tick_at_over_speed_is_a_jump() {
    let limit = Settings::BENCHTOP.protection.over_speed / Settings::BENCHTOP.control.tick_rate;
    trips_beyond(limit, |innovation| monitor().jumped(innovation));
}

#[test]
fn an_innovation_of_four_counts_of_a_coarse_encoder_is_no_jump() {
    for joint in [0, 1] {
        let mut coarse = Settings::BENCHTOP;
        for axis in &mut coarse.axes {
            axis.gear_ratio = -8.0;
        }
        coarse.axes[joint].encoder_counts = 48;
        // 16 mrad a count; a tick at the over-speed is 5 mrad.
        let four = 4.0 * (TAU / (8.0 * 48.0));
        let monitor = monitor_of(&coarse);
        let of = |value: f32| {
            let mut innovation = [0.0; 2];
            innovation[joint] = value;
            innovation
        };
        for sign in [1.0, -1.0] {
            assert!(!monitor.jumped(of(sign * four)));
            assert!(monitor.jumped(of(sign * four.next_up())));
        }
        // The other joint keeps its own limit.
        let mut other = of(0.0);
        other[1 - joint] = 0.0054;
        assert!(monitor.jumped(other));
    }
}

#[test]
fn either_joint_leaves_its_range_half_a_following_error_behind_each_limit() {
    let monitor = monitor();
    let inside = [2.0, 1.0];
    assert!(!monitor.outside(inside));
    for joint in [0, 1] {
        let [low, high] = Settings::BENCHTOP.axes[joint].angle_limits;
        for (limit, outwards) in [(low, -1.0), (high, 1.0)] {
            let mut angle = inside;
            angle[joint] = limit + outwards * 0.0099;
            assert!(!monitor.outside(angle), "{angle:?}");
            angle[joint] = limit + outwards * 0.0101;
            assert!(monitor.outside(angle), "{angle:?}");
        }
    }
}

#[test]
fn the_end_of_a_range_is_inside_it() {
    let mut exact = Settings::BENCHTOP;
    exact.protection.following_error = 0.125;
    for axis in &mut exact.axes {
        axis.angle_limits = [-1.0, 3.0];
    }
    // All numbers are powers of two or their sums, so the end is exact: 1 + 2 + 0.0625.
    let monitor = monitor_of(&exact);
    for end in [3.0625_f32, -1.0625] {
        let beyond = end * (1.0 + 1e-6);
        assert!(!monitor.outside([end, end]));
        assert!(monitor.outside([beyond, 1.0]));
        assert!(monitor.outside([1.0, beyond]));
    }
}

#[test]
fn links_2_and_3_are_too_nearly_in_line_below_half_of_the_margin_on_both_assemblies() {
    let [l1, l2, l3, l4, base] = Settings::BENCHTOP.lengths;
    let geometry = Geometry::new([l1, l2, l3, l4, base]).expect("a five-bar");
    let (u1, u4) = (Vector2::<f32>::unit(2.2), Vector2::unit(0.9));
    let mut links = geometry.links(u1, u4, Side::Left).expect("a pose");
    let monitor = monitor();
    let least = 0.5 * Settings::BENCHTOP.motion.singularity_margin * l2 * l3;
    assert!((least - 0.075 * 0.16 * 0.16).abs() < 1e-9, "half of 0.15");
    for side in [1.0, -1.0] {
        links.cross = side * least;
        assert!(!monitor.near_parallel(&links));
        links.cross = side * least.next_down();
        assert!(monitor.near_parallel(&links));
        links.cross = 0.0;
        assert!(monitor.near_parallel(&links));
    }
}

#[test]
fn a_host_is_silent_so_early_that_the_fault_is_latched_in_time() {
    // 0.1 s at 10 kHz, less 9 ticks.
    let monitor = monitor();
    assert!(!monitor.silent(0));
    assert!(!monitor.silent(991));
    assert!(monitor.silent(992));
    assert!(monitor.silent(u32::MAX));
}

/// A minute, at 10,000 ticks a second.
#[test]
fn an_arm_is_abandoned_after_a_minute_of_silence_and_stays_so() {
    let monitor = monitor();
    let last = super::in_time(600_000.0);
    for (ticks, abandoned) in [
        (0, false),
        (last, false),
        (last + 1, true),
        (u32::MAX, true),
    ] {
        assert_eq!(monitor.abandoned(ticks), abandoned, "after {ticks} ticks");
    }
}

#[test]
fn the_margin_at_c_counts_with_the_lengths_of_both_links() {
    let mut unlike = Settings::BENCHTOP;
    unlike.lengths[2] = 0.18;
    let monitor = monitor_of(&unlike);
    assert!((monitor.margin - 0.5 * 0.15 * 0.16 * 0.18).abs() < 1e-9);
}
