//! The campaign over the kinds of drive: each fault on each kind in each state, judged by the verdict on its job.
//! `cargo test` runs a few trials; `scripts/soak.sh kinds` runs all, and writes docs/verify/data/fault_campaign.csv,
//! fault_campaign_by_kind.csv beside it and docs/verify/fault-campaign.md.

mod documents;
pub(crate) mod drives;
mod faulted;
mod faults;
mod table;
mod trial;

use crate::number;
use drives::Drive;
use faults::{During, ROWS};
use fivebar_firmware::safety::Fault;
use std::sync::atomic::{AtomicUsize, Ordering};
use table::Line;
use trial::{Outcome, Prepared, Trial};

const DOCUMENT: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../docs/verify/fault-campaign.md"
);
const DATA: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../docs/verify/data/fault_campaign.csv"
);
const BY_KIND: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../docs/verify/data/fault_campaign_by_kind.csv"
);

/// Every fault on every kind of drive in every state, as often as `seeds` says.
fn trials(seeds: std::ops::Range<u64>) -> Vec<Trial> {
    let mut trials = Vec::new();
    for seed in seeds {
        for (row, of_row) in ROWS.iter().enumerate() {
            for (drive, kind) in Drive::ALL.into_iter().enumerate() {
                if of_row.not(kind).is_some() {
                    continue;
                }
                let of_state = |&during: &During| {
                    let seed = 1000 * seed + trials_seed(row, drive, during);
                    Trial {
                        drive,
                        row,
                        during,
                        seed,
                    }
                };
                trials.extend(of_row.states().iter().map(of_state));
            }
        }
    }
    trials
}

/// So that no two cells of the table have the same random values.
fn trials_seed(row: usize, drive: usize, during: During) -> u64 {
    1_000_000 * (row as u64) + 10 * (drive as u64) + during as u64
}

/// What comes of these trials, on both cores; their order does not depend on the cores.
fn campaign(trials: &[Trial]) -> Vec<(Trial, Outcome)> {
    let drives = Drive::ALL.map(Prepared::new);
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        while let Some(trial) = trials.get(next.fetch_add(1, Ordering::Relaxed)) {
            done.push((*trial, drives[trial.drive].run(trial)));
        }
        done
    };
    let mut all = std::thread::scope(|scope| {
        let threads = [scope.spawn(work), scope.spawn(work)];
        threads
            .map(|thread| thread.join().expect("no panic"))
            .concat()
    });
    all.sort_by_key(|(trial, _)| (trial.row, trial.drive, trial.during, trial.seed));
    all
}

/// The faults that the controller cannot see with this kind of drive.
fn unseeable(line: &Line) -> Vec<String> {
    let drive = Drive::ALL
        .into_iter()
        .find(|drive| drive.name() == line.kind);
    let drive = drive.unwrap_or_else(|| panic!("{}", line.kind));
    let faults = line
        .by
        .keys()
        .map(|&number| Fault::try_from(number).expect("a fault"));
    let wrong = faults.filter_map(|fault| {
        let why = drive.of_controller().sees(fault).err()?;
        Some(format!(
            "{} on {}: {fault:?}, but {why}",
            line.fault, line.kind
        ))
    });
    wrong.collect()
}

/// Checks the bounds on any trials.
fn check(lines: &[Line]) {
    let wrong: Vec<_> = lines.iter().flat_map(unseeable).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let unnamed: Vec<_> = lines.iter().filter(|line| line.unnamed > 0).collect();
    assert!(
        unnamed.is_empty(),
        "far off with status 0, and no name: {unnamed:?}"
    );
}

fn data() -> Vec<Line> {
    table::parse(&std::fs::read_to_string(DATA).expect("docs/verify/data/fault_campaign.csv"))
}

#[test]
fn no_trial_latches_a_fault_that_its_drive_cannot_show_and_none_is_far_off_unnamed() {
    let all = trials(7..8);
    // Every kind has its share; 37 is prime to the numbers of kinds and states.
    let some: Vec<_> = all.into_iter().step_by(37).collect();
    let outcomes = campaign(&some);
    check(&table::lines(&outcomes));
    for drive in 0..Drive::ALL.len() {
        assert!(some.iter().any(|trial| trial.drive == drive), "{drive}");
    }
}

#[test]
fn the_data_agree_with_what_each_drive_can_show() {
    check(&data());
}

#[test]
fn every_fault_has_its_trials_on_every_kind_of_drive_in_every_state_or_a_reason() {
    let data = data();
    let wanted = trials(0..1);
    assert_eq!(data.len(), wanted.len());
    for (line, trial) in data.iter().zip(&wanted) {
        let names = [
            ROWS[trial.row].name,
            Drive::ALL[trial.drive].name(),
            trial.during.name(),
        ];
        assert_eq!([&*line.fault, &*line.kind, &*line.state], names);
        assert!(line.trials > 0 && line.trials == line.found + line.refused + line.not_found);
    }
}

#[test]
fn page_and_table_are_those_of_the_data_and_no_cell_is_empty() {
    let page = std::fs::read_to_string(DOCUMENT).expect("docs/verify/fault-campaign.md");
    let by_kind = std::fs::read_to_string(BY_KIND).expect("fault_campaign_by_kind.csv");
    let hint = "scripts/soak.sh kinds writes it";
    assert_eq!(page, table::document(&data()), "{hint}");
    assert_eq!(by_kind, table::by_kind(&data()), "{hint}");
    for row in by_kind.lines() {
        let cells: Vec<_> = row.split(',').collect();
        assert_eq!(cells.len(), 1 + Drive::ALL.len(), "{row}");
        assert!(cells.iter().all(|cell| !cell.trim().is_empty()), "{row}");
    }
}

/// `FAULTS_COUNT` trials of each fault on each kind in each state, from `FAULTS_SEED` on; 0: the page of the data.
#[test]
#[ignore = "many minutes; scripts/soak.sh runs it"]
fn every_fault_on_every_kind_of_drive_in_every_state() {
    let (first, count) = (number("FAULTS_SEED", 1), number("FAULTS_COUNT", 1));
    let lines = match count {
        0 => data(),
        _ => table::lines(&campaign(&trials(first..first + count))),
    };
    std::fs::write(DATA, table::csv(&lines)).expect("docs can be written");
    // From the data as they are rounded there.
    std::fs::write(DOCUMENT, table::document(&data())).expect("docs can be written");
    std::fs::write(BY_KIND, table::by_kind(&data())).expect("docs can be written");
    check(&lines);
}
