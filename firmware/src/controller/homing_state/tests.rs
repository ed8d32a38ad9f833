//! One joint's search by itself: what it believes of its switch, and how far it goes.

use super::HomingError::{self, IndexAmbiguous, IndexNotFound, SwitchNotFound};
use super::{Debounced, HomingConfig, HomingState, Phase, StopDetection, limited};
use crate::settings::{AxisSettings, CREEP, HomingMethod, INDEX_SAMPLES, Settings};
use core::f32::consts::TAU;

/// Samples after which a switch is believed.
const SAMPLES: u8 = 8;

/// A range of 2 rad, half a radian to back off, 1 rad/s.
const CONFIG: HomingConfig = HomingConfig {
    speed: 1.0,
    back_off: 0.5,
    leave: 2.0,
    range: 3.0,
    acceleration: 1000.0,
    samples: SAMPLES,
    stop: None,
    index: None,
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
fn step(search: &mut HomingState, angle: f32) -> Result<(), HomingError> {
    let closed = search.switch.closed;
    search.step(&CONFIG, closed, angle, 7, 1e-3)
}

#[test]
fn the_counts_of_a_switch_are_those_of_the_first_reading_that_it_keeps() {
    let mut switch = Debounced::OPEN;
    // A disturbance, and then the contact.
    switch.read(true, 1, SAMPLES);
    switch.read(false, 2, SAMPLES);
    for counts in 10..10 + i32::from(SAMPLES) {
        assert!(!switch.closed, "at {counts}");
        switch.read(true, counts, SAMPLES);
    }
    assert_eq!((switch.closed, switch.counts), (true, 10));
    for counts in 30..30 + i32::from(SAMPLES) {
        assert!(switch.closed, "at {counts}");
        switch.read(false, counts, SAMPLES);
    }
    assert_eq!((switch.closed, switch.counts), (false, 30));
}

#[test]
fn a_search_takes_no_more_than_the_joints_range_and_speeds_up_gently() {
    let settings = Settings::BENCHTOP;
    let Settings {
        mut axes, homing, ..
    } = settings;
    let [axis, _] = &mut axes;
    axis.angle_limits = [-0.5, 2.5];
    for forward in [true, false] {
        axis.home_forward = forward;
        let config = HomingConfig::new(axis, &settings);
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

/// An arm may stand anywhere behind its switch when homing begins.
#[test]
fn backing_off_goes_farther_by_what_the_range_has_behind_home() {
    let settings = Settings::BENCHTOP;
    let leave = |forward: bool, limits: [f32; 2]| {
        let mut axis = settings.axes[0];
        (axis.home_angle, axis.home_forward) = (2.0, forward);
        axis.angle_limits = limits;
        HomingConfig::new(&axis, &settings).leave - 4.0 * settings.homing.back_off
    };
    for (forward, limits, behind) in [
        (true, [0.5, 2.75], 0.75),
        (false, [0.5, 2.75], 1.5),
        (true, [0.5, 1.5], 0.0),
        (false, [2.5, 3.5], 0.0),
    ] {
        let farther = leave(forward, limits);
        assert!(
            (farther - behind).abs() < 1e-6,
            "{forward} {limits:?}: {farther}"
        );
    }
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

const STOP: StopDetection = StopDetection {
    current: 0.9,
    speed: 0.0625,
};

/// A tick in which a stop is felt or not, believed at once.
fn feel(search: &mut HomingState, felt: bool, at: f32) -> Result<(), HomingError> {
    let config = HomingConfig {
        samples: 1,
        stop: Some(STOP),
        ..CONFIG
    };
    let counts = (1000.0 * at) as i32;
    search.step(&config, felt, at, counts, 1e-3)
}

#[test]
fn a_stop_is_felt_twice_and_left_again_and_the_reference_waits_at_it() {
    let mut search = HomingState::new(2.0);
    for _ in 0..100 {
        assert_eq!(feel(&mut search, false, 2.0), Ok(()));
    }
    assert!(search.angle > 2.05, "the reference goes ahead");
    assert_eq!(feel(&mut search, true, 2.0), Ok(()));
    assert_eq!(search.phase, Phase::BackOff { from: 2.0 });
    // One tick of the reference at most.
    assert!((search.angle - 2.0).abs() < 2e-3, "{}", search.angle);
    assert_eq!(feel(&mut search, false, 1.49), Ok(()));
    assert_eq!(search.phase, Phase::Creep { from: 1.49 });
    assert_eq!(feel(&mut search, true, 1.999), Ok(()));
    assert_eq!(
        search.phase,
        Phase::Leave {
            from: 1.999,
            counts: 1999
        }
    );
    assert_eq!(feel(&mut search, false, 1.6), Ok(()));
    assert_eq!(search.found(), None);
    assert_eq!(feel(&mut search, false, 1.498), Ok(()));
    assert_eq!(search.found(), Some(1999));
}

#[test]
fn an_obstacle_on_the_way_back_to_a_stop_ends_the_search() {
    let mut search = search(Phase::Creep { from: 1.5 }, false);
    assert_eq!(feel(&mut search, true, 1.74), Err(SwitchNotFound));
}

#[test]
fn a_stop_is_felt_with_nearly_the_greatest_current_and_a_joint_that_stands() {
    for (current, velocity, felt) in [
        (0.9, 0.0, true),
        (-0.9, -0.0624, true),
        (0.89, 0.0, false),
        (1.0, 0.063, false),
        (1.0, -0.063, false),
    ] {
        assert_eq!(
            STOP.is_felt(current, velocity),
            felt,
            "{current} {velocity}"
        );
    }
}

#[test]
fn stops_are_felt_near_the_homing_current_and_at_half_the_creeping_speed() {
    let mut settings = Settings::BENCHTOP;
    settings.home_reference.method = HomingMethod::HardStop;
    settings.home_reference.samples = 70;
    let [axis, _] = &settings.axes;
    let config = HomingConfig::new(axis, &settings);
    assert_eq!(config.samples, 70);
    // 1.2 A; an eighth of 0.7 rad/s.
    let stop = config.stop.expect("hard stops");
    assert!((stop.current - 1.08).abs() < 1e-6, "{stop:?}");
    assert!((stop.speed - 0.043_75).abs() < 1e-6, "{stop:?}");
}

/// A range of 2 rad, and an index pulse in each radian.
const INDEX: HomingConfig = HomingConfig {
    back_off: 0.25,
    index: Some(1.0),
    ..CONFIG
};

/// Creeps away from the switch at 5 rad, in millirads of one count each; the encoder shows its index in
/// these counts.
fn creep_to_index(shown: impl Fn(i32) -> bool) -> Result<i32, HomingError> {
    let mut search = search(Phase::Index { from: 5.0 }, true);
    for counts in (3000..=5000).rev() {
        // Each count lasts twice the samples.
        for _ in 0..2 * INDEX_SAMPLES {
            let angle = 1e-3 * counts as f32;
            search.step(&INDEX, shown(counts), angle, counts, 1e-3)?;
        }
        if let Some(counts) = search.found() {
            return Ok(counts);
        }
    }
    panic!("no end");
}

#[test]
fn a_joint_that_has_found_its_switch_creeps_away_from_it_to_its_index_pulse() {
    let mut search = search(Phase::Creep { from: 4.5 }, true);
    assert_eq!(search.step(&INDEX, true, 5.0, 5000, 1e-3), Ok(()));
    assert_eq!(search.phase, Phase::Index { from: 5.0 });
    assert!(search.seeks_index());
    for _ in 0..10 {
        assert_eq!(search.step(&INDEX, false, 5.0, 5000, 1e-3), Ok(()));
    }
    assert_eq!(search.rate, -0.125);
}

#[test]
fn the_first_pulse_of_a_count_or_more_is_found_and_a_disturbance_is_not() {
    assert_eq!(creep_to_index(|counts| counts == 4600), Ok(4600));
    assert_eq!(
        creep_to_index(|counts| (4590..=4600).contains(&counts)),
        Ok(4600)
    );
    let mut search = search(Phase::Index { from: 5.0 }, false);
    for tick in 0..100 {
        let disturbed = tick % 2 == 0;
        assert_eq!(search.step(&INDEX, disturbed, 4.6, 4600, 1e-3), Ok(()));
    }
    assert_eq!(search.found(), None);
}

#[test]
fn a_pulse_within_a_sixteenth_of_a_turn_from_the_switch_is_of_no_certain_turn() {
    let pulse = |at: i32| creep_to_index(move |counts| counts == at);
    assert_eq!(pulse(4930), Ok(4930));
    assert_eq!(pulse(4945), Err(IndexAmbiguous));
    assert_eq!(pulse(4070), Ok(4070));
    assert_eq!(pulse(4055), Err(IndexAmbiguous));
    // The switch closed in a pulse: the next one is a turn away.
    let in_pulse = |counts| counts > 4995 || counts == 4000;
    assert_eq!(creep_to_index(in_pulse), Err(IndexAmbiguous));
}

#[test]
fn an_index_output_that_stays_as_it_is_has_no_pulse() {
    assert_eq!(creep_to_index(|_| false), Err(IndexNotFound));
    assert_eq!(creep_to_index(|_| true), Err(IndexNotFound));
    // Nor is one sought farther than the joint can go.
    let disc_at_joint = HomingConfig {
        index: Some(TAU),
        ..INDEX
    };
    let mut search = search(Phase::Index { from: 5.0 }, false);
    for (gone, result) in [(2.99, Ok(())), (3.01, Err(IndexNotFound))] {
        assert_eq!(
            search.step(&disc_at_joint, false, 5.0 - gone, 0, 1e-3),
            result
        );
    }
}

#[test]
fn the_way_between_two_pulses_is_that_of_the_joint() {
    let mut settings = Settings::BENCHTOP;
    let [axis, _] = settings.axes;
    assert_eq!(HomingConfig::new(&axis, &settings).index, None);
    settings.home_reference.method = HomingMethod::Index;
    for gear_ratio in [8.0, -8.0] {
        let axis = AxisSettings { gear_ratio, ..axis };
        let between = HomingConfig::new(&axis, &settings).index.expect("pulses");
        assert!((between - TAU / 8.0).abs() < 1e-6, "{between} rad");
    }
}

#[test]
fn what_is_found_slowly_is_found_at_the_creeping_share_of_the_speed() {
    let config = HomingConfig {
        speed: 0.4,
        ..CONFIG
    };
    for (phase, rate) in [
        (Phase::Creep { from: 0.0 }, CREEP * 0.4),
        (Phase::Index { from: 0.0 }, -CREEP * 0.4),
        (
            Phase::Leave {
                from: 0.0,
                counts: 7,
            },
            -CREEP * 0.4,
        ),
    ] {
        let mut search = search(phase, false);
        let config = HomingConfig {
            index: Some(1.0),
            ..config
        };
        search.step(&config, false, 0.1, 7, 1e-3).unwrap();
        assert!((search.rate - rate).abs() < 1e-6, "{}", search.rate);
    }
}
