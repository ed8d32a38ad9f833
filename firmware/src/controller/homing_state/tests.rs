//! One joint's search by itself: what it believes of its switch, and how far it goes.

use super::{DEBOUNCE_TICKS, Debounced, HomingConfig, HomingState, Phase, SwitchNotFound, limited};
use crate::settings::Settings;

/// A range of 2 rad, half a radian to back off, 1 rad/s.
const CONFIG: HomingConfig = HomingConfig {
    speed: 1.0,
    back_off: 0.5,
    range: 3.0,
    acceleration: 1000.0,
};

/// A search that has read its switch as `closed` before.
fn search(phase: Phase, closed: bool) -> HomingState {
    HomingState {
        phase,
        switch: Debounced {
            closed,
            ..Debounced::OPEN
        },
        ..HomingState::new(0.0)
    }
}

/// One tick with the switch as before, at `angle` [rad].
fn step(search: &mut HomingState, angle: f32) -> Result<(), SwitchNotFound> {
    search.step(&CONFIG, search.switch.closed, angle, 7, 1e-3)
}

#[test]
fn the_counts_of_a_switch_are_those_of_the_first_reading_that_it_keeps() {
    let mut switch = Debounced::OPEN;
    // A disturbance, and then the contact.
    switch.read(true, 1);
    switch.read(false, 2);
    for counts in 10..10 + i32::from(DEBOUNCE_TICKS) {
        assert!(!switch.closed, "at {counts}");
        switch.read(true, counts);
    }
    assert_eq!((switch.closed, switch.counts), (true, 10));
    for counts in 30..30 + i32::from(DEBOUNCE_TICKS) {
        assert!(switch.closed, "at {counts}");
        switch.read(false, counts);
    }
    assert_eq!((switch.closed, switch.counts), (false, 30));
}

#[test]
fn a_search_takes_no_more_than_the_joints_range_and_speeds_up_gently() {
    let Settings {
        mut axes, homing, ..
    } = Settings::BENCHTOP;
    let [axis, _] = &mut axes;
    axis.angle_limits = [-0.5, 2.5];
    for forward in [true, false] {
        axis.home_forward = forward;
        let config = HomingConfig::new(axis, &homing);
        // 3 rad, and two ways of backing off: one behind each end.
        assert_eq!(config.range, 3.0 + 2.0 * homing.back_off);
        let mut search = HomingState::new(0.0);
        let mut rates = (0..1200).map(|_| {
            search.step(&config, false, 0.0, 0, 1e-4).expect("in range");
            search.rate.abs() / homing.speed
        });
        // Its speed is reached after 0.1 s.
        assert!(
            rates
                .nth(499)
                .is_some_and(|share| (share - 0.5).abs() < 0.01)
        );
        assert!(
            rates
                .nth(599)
                .is_some_and(|share| (share - 1.0).abs() < 0.01)
        );
    }
}

#[test]
fn an_approach_fails_behind_its_range_in_either_direction() {
    for sign in [1.0, -1.0] {
        let mut approach = search(Phase::Approach { from: 10.0 }, false);
        assert_eq!(step(&mut approach, 10.0 + sign * 3.0), Ok(()));
        assert_eq!(step(&mut approach, 10.0 + sign * 3.01), Err(SwitchNotFound));
    }
}

#[test]
fn backing_off_fails_when_the_switch_stays_closed_for_four_times_its_way() {
    let mut back_off = search(Phase::BackOff { from: 10.0 }, true);
    for gone in [0.4, 0.6, 2.0] {
        assert_eq!(step(&mut back_off, 10.0 - gone), Ok(()));
        assert_eq!(back_off.phase, Phase::BackOff { from: 10.0 });
    }
    assert_eq!(step(&mut back_off, 7.99), Err(SwitchNotFound));
}

#[test]
fn backing_off_ends_when_the_switch_is_open_and_the_way_is_gone() {
    let mut back_off = search(Phase::BackOff { from: 10.0 }, false);
    assert_eq!(step(&mut back_off, 9.51), Ok(()));
    assert_eq!(back_off.phase, Phase::BackOff { from: 10.0 });
    assert_eq!(step(&mut back_off, 9.5), Ok(()));
    assert_eq!(back_off.phase, Phase::Creep { from: 9.5 });
}

#[test]
fn creeping_fails_behind_six_times_the_way() {
    let mut creep = search(Phase::Creep { from: 10.0 }, false);
    for gone in [0.5, 2.9, 3.0] {
        assert_eq!(step(&mut creep, 10.0 + gone), Ok(()));
    }
    assert_eq!(step(&mut creep, 13.01), Err(SwitchNotFound));
}

#[test]
fn each_phase_has_its_speed_and_direction() {
    let fast = HomingConfig {
        speed: 2.0,
        ..CONFIG
    };
    for (phase, speed) in [
        (Phase::Approach { from: 0.0 }, 2.0),
        (Phase::BackOff { from: 0.0 }, -2.0),
        (Phase::Creep { from: 0.0 }, 0.25),
        (Phase::Found { counts: 0 }, 0.0),
    ] {
        let mut search = search(phase, false);
        for _ in 0..10 {
            assert_eq!(search.step(&fast, false, 0.0, 7, 1e-3), Ok(()));
        }
        assert_eq!(search.rate, speed, "{phase:?}");
    }
}

#[test]
fn the_reference_accelerates_by_its_limit_and_moves_at_its_rate() {
    let gentle = HomingConfig {
        acceleration: 10.0,
        ..CONFIG
    };
    let mut search = HomingState::new(2.0);
    for tick in 1..=200_i16 {
        search.step(&gentle, false, 2.0, 0, 1e-3).expect("in range");
        let rate = (f32::from(tick) * 0.01).min(1.0);
        assert!((search.rate - rate).abs() < 1e-5, "tick {tick}");
    }
    // 0.0505 rad while it accelerates, and 0.1 s at 1 rad/s.
    assert!((search.angle - 2.1505).abs() < 1e-4, "{}", search.angle);
}

#[test]
fn a_limited_value_keeps_its_sign_and_what_is_not_a_number_stays_so() {
    for (value, expected) in [(0.5, 0.5), (-0.5, -0.5), (3.0, 1.0), (-3.0, -1.0)] {
        assert_eq!(limited(value, 1.0), expected);
    }
    assert!(limited(f32::NAN, 1.0).is_nan());
}
