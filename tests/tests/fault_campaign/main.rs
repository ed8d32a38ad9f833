//! A campaign of single faults of the simulated arm: random faults at random times in every state,
//! on five arms with brushed motors, judged by what the arm itself does. `cargo test` runs a short part;
//! `scripts/soak.sh faults` runs as many as it is told and writes docs/verify/data/fault_campaign_brushed.csv.
//! `kinds` is the campaign over all kinds of drive.
//!
//! After a fault the host goes on as before, and it does nothing once a fault is latched.

mod arms;
mod host;
mod injected;
mod kinds;
mod outcome;
mod table;
mod trial;
mod wiring;

use injected::{KINDS, Kind};
use outcome::Outcome;
use std::sync::atomic::{AtomicU64, Ordering};
use trial::Trial;

const DATA: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../docs/verify/data/fault_campaign_brushed.csv"
);

/// The trials of these seeds, on both cores; their order does not depend on the cores.
fn campaign(seeds: std::ops::Range<u64>) -> Vec<(Trial, Outcome)> {
    let arms = arms::all();
    let next = AtomicU64::new(seeds.start);
    let work = || {
        let mut done = Vec::new();
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= seeds.end {
                return done;
            }
            let trial = Trial::of(seed, &arms);
            let outcome = host::run(&trial, &arms[trial.arm]);
            done.push((trial, outcome));
        }
    };
    let mut all = std::thread::scope(|scope| {
        let threads = [scope.spawn(work), scope.spawn(work)];
        threads
            .map(|thread| thread.join().expect("no panic"))
            .concat()
    });
    all.sort_by_key(|(trial, _)| trial.seed);
    all
}

/// The trials that break a bound.
fn broken(trials: &[(Trial, Outcome)]) -> Vec<String> {
    let broken = trials.iter().filter(|(_, outcome)| outcome.is_broken());
    broken
        .map(|(trial, outcome)| format!("{trial:?}: {outcome:?}"))
        .collect()
}

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| {
        text.parse()
            .unwrap_or_else(|error| panic!("{name}={text}: {error}"))
    })
}

#[test]
fn after_a_random_fault_in_any_state_current_and_speed_stay_bounded_and_a_latched_fault_ends_motion()
 {
    let broken = broken(&campaign(1..21));
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
#[ignore = "a minute: ./ci.sh tables"]
fn whole_table_after_more_random_faults_current_and_speed_stay_bounded() {
    let broken = broken(&campaign(1..201));
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

/// Seed 4655: a belt whose coupling loses 87 % of the motion makes its loop swing from limit to limit at 121 Hz.
#[test]
fn a_coupling_that_slips_leaves_no_motor_above_twice_its_continuous_current_for_2_s() {
    let trials = campaign(4655..4656);
    assert!(broken(&trials).is_empty(), "{trials:?}");
}

#[test]
fn every_kind_of_fault_has_a_row_in_the_table() {
    let data = std::fs::read_to_string(DATA).expect("docs/verify/data/fault_campaign_brushed.csv");
    for Kind { name, .. } in KINDS {
        assert!(data.contains(&format!("\n{name},all,")), "{name}");
    }
}

/// `FAULTS_COUNT` trials from `FAULTS_SEED` on; writes docs/verify/data/fault_campaign_brushed.csv.
#[test]
#[ignore = "many minutes; scripts/soak.sh runs it"]
fn many_random_faults_in_every_state_on_every_arm() {
    let first = number("FAULTS_SEED", 1);
    let trials = campaign(first..first + number("FAULTS_COUNT", 100));
    std::fs::write(DATA, table::csv(&trials)).expect("docs can be written");
    let broken = broken(&trials);
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}
