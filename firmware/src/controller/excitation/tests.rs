//! The bounds of an excitation, and what ends it.

use super::*;
use crate::controller::Request;
use crate::drives::{BrushedCommand, BrushedSample};
use crate::{Controller, SensorSample, Settings};

/// 0.5 A at most, and 0.1 rad.
fn excitation() -> Excitation {
    Excitation {
        joint: 1,
        of: Excited::Voltage,
        offset: 1.0,
        amplitude: 0.25,
        hold: 1,
        ticks: 100,
        current: 0.5,
        travel: 0.1,
    }
}

fn is_bounded(change: impl FnOnce(&mut Excitation)) -> bool {
    let mut excitation = excitation();
    change(&mut excitation);
    excitation.is_bounded(&Settings::BENCHTOP)
}

#[test]
fn a_voltage_drives_at_most_twice_the_current_through_the_winding_at_rest() {
    // 2 · 2.3 Ω · 0.5 A.
    assert!(is_bounded(|it| it.offset = 2.049));
    assert!(!is_bounded(|it| it.offset = 2.06));
    assert!(!is_bounded(|it| it.offset = -2.06));
    assert!(!is_bounded(|it| it.amplitude = 1.31));
}

#[test]
fn an_excitation_without_current_travel_or_time_is_refused() {
    assert!(is_bounded(|_| ()));
    assert!(!is_bounded(|it| {
        (it.current, it.offset, it.amplitude) = (0.0, 0.0, 0.0);
    }));
    assert!(!is_bounded(|it| it.travel = 0.0));
    assert!(!is_bounded(|it| it.ticks = 0));
    assert!(!is_bounded(|it| it.hold = 0));
    assert!(!is_bounded(|it| it.joint = 2));
}

#[test]
fn either_motors_current_and_either_joints_travel_end_an_excitation_beyond_their_limits() {
    let mut state = ExcitationState::none(1e4);
    state.begin(&excitation());
    state.start = [1.0, -1.0];
    for sign in [1.0, -1.0] {
        for joint in [0, 1] {
            let mut current = [0.0; 2];
            let mut reached = |value: f32| {
                current[joint] = sign * value;
                state.reached([1.0, -1.0], current)
            };
            assert_eq!(reached(0.5), None);
            assert_eq!(reached(0.501), Some(ExcitationEnd::Current));
            assert_eq!(reached(5.0), Some(ExcitationEnd::Current));
            let reached = |travel: f32| {
                let mut angle = state.start;
                angle[joint] += sign * travel;
                state.reached(angle, [0.0; 2])
            };
            assert_eq!(reached(0.099), None);
            assert_eq!(reached(0.101), Some(ExcitationEnd::Travel));
            assert_eq!(reached(0.5), Some(ExcitationEnd::Travel));
        }
    }
    state.ticks = 100;
    assert_eq!(
        state.reached(state.start, [0.0; 2]),
        Some(ExcitationEnd::Time)
    );
}

#[test]
fn the_sequence_begins_low_and_has_as_many_high_values_as_low_ones() {
    let mut state = ExcitationState::none(1e4);
    state.begin(&excitation());
    let values: [f32; 1000] = core::array::from_fn(|_| state.value());
    assert_eq!(values[0], 0.75);
    let high = values.iter().filter(|&&value| value == 1.25).count();
    assert!((400..600).contains(&high), "{high} of 1000");
}

/// The ticks of braking until the bridges go off, with these joint speeds [rad/s].
fn braked_for(velocity: [f32; 2]) -> u32 {
    let settings = Settings::BENCHTOP.check().unwrap();
    let mut controller = Controller::new(&settings);
    let request = Request::Excite(excitation());
    controller.request(request).unwrap();
    let measurement = Measurement {
        innovation: [0.0; 2],
        velocity,
    };
    let braked = |_: &u32| {
        matches!(
            controller.brake_excited(&measurement),
            UnpoweredOutput::Excited
        )
    };
    1 + (0..10_000).take_while(braked).count() as u32
}

#[test]
fn motors_stay_shorted_for_5_ms_and_until_both_joints_rest_or_half_a_second() {
    // 10 kHz.
    for rests in [[0.0, 0.0], [0.049, -0.049]] {
        assert_eq!(braked_for(rests), 50);
    }
    for turns in [[0.05, 0.0], [0.0, 0.05], [-1.0, 0.0], [0.0, -1.0], [1.0; 2]] {
        assert_eq!(braked_for(turns), 5000, "{turns:?}");
    }
}

#[test]
fn an_excitation_takes_nothing_over_from_the_one_before() {
    let mut state = ExcitationState::none(1e4);
    let mut values = || {
        state.begin(&excitation());
        assert_eq!((state.end, state.ticks), (None, 0));
        let values: [f32; 99] = core::array::from_fn(|_| state.value());
        (state.end, state.ticks) = (Some(ExcitationEnd::Travel), 50);
        values
    };
    assert_eq!(values(), values());
}

#[test]
fn an_excitation_s_duty_that_is_not_a_number_switches_off_in_its_tick() {
    let sample = SensorSample {
        drives: BrushedSample {
            current: [2048; 2],
            bus_voltage: 2048,
        },
        ..SensorSample::default()
    };
    let mut controller = Controller::new(&Settings::BENCHTOP.check().unwrap());
    controller.tick(&sample);
    let wanted = Excitation {
        of: Excited::Current,
        offset: 0.1,
        amplitude: 0.0,
        ..excitation()
    };
    controller.request(Request::Excite(wanted)).unwrap();
    for _ in 0..20 {
        controller.tick(&sample);
    }
    assert!(controller.tick(&sample).enable[1], "it drives");
    controller.drives.spoil(five_bar::Joint::Joint4);
    let command = controller.tick(&sample);
    assert_eq!(
        (command.enable, command.drives),
        ([false; 2], BrushedCommand::default())
    );
    assert_eq!(controller.status().fault, Some(Fault::NotANumber));
}
