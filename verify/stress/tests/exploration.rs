//! All states of the controller, explored.

use fivebar_firmware::safety::{Fault, State};
use fivebar_stress::exploration::{Exploration, explore, explore_open_loop};
use std::time::Instant;

/// The figures are in this document.
const FAULTS: &str = include_str!("../../../docs/use/faults.md");

/// The number before a word in the sentence that states the figures.
fn stated(word: &str) -> f64 {
    let (_, sentence) = FAULTS
        .split_once("The exploration finds")
        .expect("the figures");
    let (before, _) = sentence.split_once(word).expect("the word");
    let number = before.split_whitespace().next_back().expect("a number");
    number.replace(',', "").parse().expect("a number")
}

fn explored(most: usize) -> Exploration {
    match explore(most) {
        Ok(found) => found,
        Err(counterexample) => panic!("{counterexample}"),
    }
}

/// Breadth first: those that the fewest events lead to.
#[test]
fn every_event_in_the_first_states_keeps_the_rules_and_leaves_a_way_out() {
    let first = 6000;
    let found = explored(first);
    assert!(found.states > first && found.edges > 20 * first);
    assert!(found.ways_out[0] + found.ways_out[1] >= first);
    for state in State::ALL {
        assert!(found.reached.contains(&state), "{state:?}");
    }
}

#[test]
#[ignore = "a minute: ./ci.sh tables"]
fn whole_table_every_event_in_every_state_keeps_the_rules_and_leaves_a_way_out() {
    let begun = Instant::now();
    let Exploration {
        states,
        edges,
        ticks,
        reached,
        faults,
        detected,
        ways_out: [to_motion, to_reason],
    } = explored(usize::MAX);
    println!(
        "{states} states, {edges} events in them, {ticks} ticks, {:.0} s; ways out to motion from \
         {to_motion}, to a named reason from {to_reason}; faults that ticks found: {detected:?}",
        begun.elapsed().as_secs_f64()
    );
    for state in State::ALL {
        assert!(reached.contains(&state), "{state:?}");
    }
    for fault in Fault::all() {
        assert!(faults.contains(&fault), "{fault:?}");
    }
    // Every change of the controller changes the figures a little.
    for (figure, found) in [
        ("abstract states", states as f64),
        ("events", edges as f64),
        ("ticks", ticks as f64),
    ] {
        let share = found / stated(figure);
        assert!(
            (0.5..2.0).contains(&share),
            "{figure}: {found}, {share} of those stated"
        );
    }
}

fn explored_open_loop(most: usize) -> Exploration {
    match explore_open_loop(most) {
        Ok(found) => found,
        Err(counterexample) => panic!("{counterexample}"),
    }
}

/// Steppers are not excited, cross no singularity, and give way to no hand.
fn reached_on_open_loop(found: &Exploration) {
    for state in State::ALL {
        let reachable = !matches!(state, State::Exciting | State::Crossing | State::Compliant);
        assert!(!reachable || found.reached.contains(&state), "{state:?}");
    }
}

/// Breadth first: those that the fewest events lead to.
#[test]
fn an_arm_on_open_loop_drives_is_homed_only_with_power_in_the_first_states() {
    let first = 2000;
    let found = explored_open_loop(first);
    assert!(found.states > first && found.edges > 20 * first);
    reached_on_open_loop(&found);
}

#[test]
#[ignore = "half a minute: ./ci.sh tables"]
fn whole_table_an_arm_on_open_loop_drives_is_homed_only_with_power_in_every_state() {
    let found = explored_open_loop(usize::MAX);
    reached_on_open_loop(&found);
    for fault in Fault::all() {
        assert!(found.faults.contains(&fault), "{fault:?}");
    }
}
