//! Every mistake that `[wiring]` of a scenario can make, on every kind of drive: what finds it, as
//! docs/verify/data/wiring_mistakes.csv has it. `cargo test` tries each key on one kind of drive, and reads all refusals;
//! with FIVEBAR_UPDATE in the environment, `whole_table` writes the table and docs/use/wiring-mistakes.md.

mod document;
mod trial;

use crate::kinds::drives::Drive;
use document::{DOCUMENT, TABLE};
use fivebar_plant::{Wiring, WiringKey};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A mistake: a key and a value.
#[derive(Clone, Copy)]
struct Mistake {
    key: WiringKey,
    value: &'static str,
}

impl Mistake {
    /// Every key of the reader, with the values that are tried of it.
    fn all() -> Vec<Self> {
        let keys = Wiring::default().keys().into_iter();
        let all = keys.flat_map(|key| {
            let values = values(key.name).into_iter();
            values.map(move |value| Self { key, value })
        });
        all.collect()
    }

    fn name(&self) -> String {
        format!("{} = {}", self.key.name, self.value)
    }

    fn is_of(&self, drive: Drive) -> bool {
        self.key.kinds.contains(&drive.of_controller())
    }
}

/// The values that are tried of a key: a mistake at joint 1, or the numbers of this list.
fn values(key: &str) -> Vec<&'static str> {
    let right = serde_json::to_value(Wiring::default()).expect("JSON");
    match &right[key] {
        serde_json::Value::Bool(_) => return vec!["true"],
        serde_json::Value::Array(pair) if pair[0].is_boolean() => return vec!["[true, false]"],
        _ => {}
    }
    match key {
        "counts" => vec!["[1.0, 0.0]", "[-0.5, 0.0]"],
        "microsteps" => vec!["[2.0, 1.0]", "[4.0, 1.0]", "[0.5, 1.0]"],
        "current_share" => vec!["[0.7, 1.0]", "[0.05, 1.0]"],
        "supply_share" => vec!["0.5"],
        "orders_lost" | "answers_lost" => vec!["[0.02, 0.0]", "[0.5, 0.0]"],
        "torque_constant" => vec!["[0.5, 0.0]", "[-0.5, 0.0]"],
        "zero_shift" => vec!["[0.05, 0.0]"],
        _ => panic!("no value to try for `{key}`"),
    }
}

/// What comes of these mistakes, on both cores: the cells of the table.
fn cells(trials: &[(Mistake, Drive)]) -> Vec<String> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some((mistake, drive)) = trials.get(index) else {
                return done;
            };
            let scenario = trial::scenario(*drive, &mistake.key, mistake.value);
            let scenario = scenario.unwrap_or_else(|refusal| panic!("{refusal}"));
            let outcome = trial::run(*drive, &scenario);
            let what = format!("{} on {}: {outcome:?}", mistake.name(), drive.name());
            assert!(
                outcome.is_off || outcome.rests(),
                "it moves on under power: {what}"
            );
            done.push((index, document::cell(mistake.key.name, &outcome.found)));
        }
    };
    let mut all = std::thread::scope(|scope| {
        let threads = [scope.spawn(work), scope.spawn(work)];
        threads
            .map(|thread| thread.join().expect("no panic"))
            .concat()
    });
    all.sort_by_key(|(index, _)| *index);
    all.into_iter().map(|(_, cell)| cell).collect()
}

/// Each mistake on each kind of drive that can have it.
fn trials() -> Vec<(Mistake, Drive)> {
    let of_mistake = |mistake: Mistake| {
        let drives = Drive::ALL.into_iter();
        let able = drives.filter(move |&drive| mistake.is_of(drive));
        able.map(move |drive| (mistake, drive))
    };
    Mistake::all().into_iter().flat_map(of_mistake).collect()
}

/// The kinds of drive, those first whose runs take least time.
const CHEAPEST: [Drive; 6] = [
    Drive::Odrive,
    Drive::Mit,
    Drive::StepperWithEncoder,
    Drive::Brushed,
    Drive::Stepper,
    Drive::HobbyServo,
];

/// The table, as committed.
fn committed() -> String {
    std::fs::read_to_string(TABLE).expect("docs/verify/data/wiring_mistakes.csv")
}

#[test]
fn each_mistake_is_found_as_the_document_has_it_on_one_kind_of_drive() {
    let table = committed();
    let all = Mistake::all();
    let some: Vec<_> = all
        .iter()
        .enumerate()
        .map(|(index, mistake)| {
            let able = CHEAPEST.into_iter().filter(|&drive| mistake.is_of(drive));
            let able: Vec<_> = able.take(2).collect();
            (*mistake, able[(index + 1) % able.len()])
        })
        .collect();
    for ((mistake, drive), cell) in some.iter().zip(cells(&some)) {
        let column = Drive::ALL.iter().position(|it| it == drive);
        let written = document::cells(&table, &mistake.name())[column.expect("a column")];
        assert_eq!(written, cell, "{} on {}", mistake.name(), drive.name());
    }
}

#[test]
fn the_table_has_a_row_for_each_key_of_the_reader_and_no_empty_cell() {
    let page = std::fs::read_to_string(DOCUMENT).expect("docs/use/wiring-mistakes.md");
    assert_eq!(page, document::page());
    let table = committed();
    let all = Mistake::all();
    assert_eq!(table.lines().count(), 1 + all.len());
    for mistake in &all {
        let name = mistake.name();
        let cells = document::cells(&table, &name);
        assert_eq!(cells.len(), Drive::ALL.len(), "{name}");
        for (cell, drive) in cells.into_iter().zip(Drive::ALL) {
            let is_tried = !["", "–"].contains(&cell);
            assert_eq!(is_tried, mistake.is_of(drive), "{name}");
        }
    }
}

#[test]
fn a_key_of_other_drives_is_refused_by_name_with_its_line_and_the_drives_that_have_it() {
    for mistake in Mistake::all() {
        for drive in Drive::ALL
            .into_iter()
            .filter(|&drive| !mistake.is_of(drive))
        {
            let read = trial::scenario(drive, &mistake.key, mistake.value);
            let refusal = read.expect_err(mistake.key.name);
            let start = format!(
                "wrong.toml, line 4: `{}` of [wiring] is a",
                mistake.key.name
            );
            assert!(refusal.starts_with(&start), "{refusal}");
            assert!(refusal.ends_with("leave it out"), "{refusal}");
        }
    }
}

#[test]
#[ignore = "a minute: ./ci.sh tables"]
fn whole_table_each_mistake_on_each_kind_of_drive_is_found_as_the_document_has_it() {
    let trials = trials();
    let mut cells = cells(&trials).into_iter();
    let rows = Mistake::all().into_iter().map(|mistake| {
        let cells = Drive::ALL.map(|drive| match mistake.is_of(drive) {
            true => cells.next().expect("a trial"),
            false => "–".into(),
        });
        (mistake.name(), cells)
    });
    let table = document::table(rows);
    if std::env::var_os("FIVEBAR_UPDATE").is_some() {
        std::fs::write(TABLE, table).expect("it can be written");
        std::fs::write(DOCUMENT, document::page()).expect("it can be written");
        return;
    }
    let hint = "FIVEBAR_UPDATE=1 cargo test -p fivebar-tests --test fault_campaign -- --ignored whole_table writes it";
    assert_eq!(committed(), table, "{hint}");
}
