//! Random arms on belts draw the demonstration: none is unstable, none errs by more than 1.5 times its prediction.

use crate::arms::RandomArm;
use crate::prediction::predicted;
use fivebar_files::scenario::Scenario;
use fivebar_plant::Mismatch;
use fivebar_sim::simulation::{Record, Simulate};

/// The least and the greatest error per the predicted one.
const LEAST: f64 = 0.5;
const MOST: f64 = 1.5;

/// What an arm did.
struct Outcome {
    /// Tip error without mismatch, with it and as predicted [m], root mean square.
    exact: f64,
    seen: f64,
    predicted: f64,
}

/// The error is what went wrong with the arm.
fn drawn(arm: &RandomArm, seed: u64) -> Result<Outcome, String> {
    let mut scenario = Scenario::demonstration(arm.robot.clone());
    scenario.seed = seed;
    scenario.mismatch = arm.mismatch;
    scenario.fit().expect("it draws the demonstration");
    let run = |mismatch: Mismatch| -> Result<Record, String> {
        let mut scenario = scenario.clone();
        scenario.mismatch = mismatch;
        let job = scenario.job().expect("the demonstration");
        let (_, record) = scenario.simulate(&job, &mut |_| ()).expect("it runs");
        match record.faults[..] {
            [] => Ok(record),
            [(_, fault), ..] => Err(format!("{fault:?} with {mismatch:?}")),
        }
    };
    let (exact, record) = (run(Mismatch::NONE)?, run(arm.mismatch)?);
    let end = record.job_time.expect("it draws");
    let samples = record.trace.samples();
    let samples = &samples[..samples.partition_point(|sample| sample.time <= end)];
    let by_loads = predicted(arm, samples).ok_or("its linear loop is unstable")?;
    Ok(Outcome {
        exact: exact.tip_error.rms_m,
        seen: record.tip_error.rms_m,
        predicted: by_loads.hypot(exact.tip_error.rms_m),
    })
}

/// Draws with the arms of these seeds, and prints the rows of docs/verify/data/belts.csv.
fn all_drawn(seeds: impl Iterator<Item = u64>) {
    let mut wrong = Vec::new();
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for seed in seeds {
        let arm = RandomArm::new(seed);
        if arm.robot.gains().belts.is_none() {
            wrong.push((seed, "it has no gains for its belts".into()));
            continue;
        }
        let outcome = match drawn(&arm, seed) {
            Ok(outcome) => outcome,
            Err(what) => {
                wrong.push((seed, what));
                continue;
            }
        };
        let share = outcome.seen / outcome.predicted;
        let [exact, seen, predicted] =
            [outcome.exact, outcome.seen, outcome.predicted].map(|m| 1e6 * m);
        let [belt1, belt4] = arm.stiffness;
        println!("{seed},{belt1:.0},{belt4:.0},{exact:.2},{seen:.2},{predicted:.2},{share:.2}");
        // A prediction far above the error would be none.
        if !(LEAST..=MOST).contains(&share) {
            wrong.push((seed, format!("{share:.2} times its prediction")));
        }
        least = least.min(share);
        most = most.max(share);
    }
    println!("{least:.2} to {most:.2} times their prediction");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().expect("a number"))
}

#[test]
fn a_random_arm_on_belts_is_stable_and_errs_as_predicted() {
    // Its belts differ from each other.
    all_drawn(2..3);
}

#[test]
#[ignore = "half a minute: ./ci.sh tables"]
fn whole_table_of_random_arms_on_belts_that_err_as_predicted() {
    all_drawn(1..4);
}

/// `BELTS_SEED` and `BELTS_COUNT` say which arms.
#[test]
#[ignore = "some seconds for each arm"]
fn many_random_arms_on_belts_are_stable_and_err_as_predicted() {
    let first = number("BELTS_SEED", 1);
    all_drawn(first..first + number("BELTS_COUNT", 100));
}

/// The median of the numbers.
fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    0.5 * (numbers[(numbers.len() - 1) / 2] + numbers[numbers.len() / 2])
}

#[test]
fn the_page_sums_its_data_up() {
    let page = include_str!("../../../docs/verify/belts.md").replace('\n', " ");
    let data = include_str!("../../../docs/verify/data/belts.csv");
    let column = |index: usize| -> Vec<f64> {
        let rows = data.lines().skip(1).map(|row| row.split(',').nth(index));
        rows.map(|it| it.expect("a column").parse().expect("a number"))
            .collect()
    };
    let [exact, seen, share] = [3, 4, 6].map(column);
    assert_eq!(seen.len(), 100);
    let least = |of: &[f64]| of.iter().copied().fold(f64::INFINITY, f64::min);
    let most = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
    for sentence in [
        format!(
            "{:.2} to {:.2} times their prediction",
            least(&share),
            most(&share)
        ),
        format!("{:.2} times in the median", median(share)),
        format!("{:.2} to {:.2} µm RMS", least(&seen), most(&seen)),
        format!("{:.2} µm in the median,", median(seen)),
        format!("{:.2} µm in the median of the exact arms", median(exact)),
    ] {
        assert!(page.contains(&sentence), "{sentence}");
    }
}
