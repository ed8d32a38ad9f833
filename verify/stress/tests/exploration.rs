//! All states of the controller, explored.

use fivebar_firmware::safety::{Fault, State};
use fivebar_stress::exploration::{Exploration, explore};
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

#[test]
fn every_event_in_every_state_keeps_the_rules_and_leaves_a_way_out() {
    let begun = Instant::now();
    let found = match explore() {
        Ok(found) => found,
        Err(counterexample) => panic!("{counterexample}"),
    };
    let Exploration {
        states,
        edges,
        ticks,
        reached,
        faults,
        detected,
        ways_out: [to_motion, to_reason],
    } = found;
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
