//! The bounds of an excitation, and what ends it.

use super::*;

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
