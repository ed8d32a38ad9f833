//! The table of all kinds, docs/verify/data/hostile_files.csv: what each takes in an optimised build.
//!
//! `FIVEBAR_UPDATE=1 cargo test --release -p fivebar-files --test hostile -- --ignored` measures it anew.

use crate::{Measurement, kinds, measured, why_wrong};

const FILE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../docs/verify/data/hostile_files.csv"
);
const HEADER: [&str; 4] = ["kind", "seconds", "mebibytes", "outcome"];

fn committed() -> Vec<Measurement> {
    let mut reader = csv::Reader::from_path(FILE).expect("a table");
    let row = |row: csv::StringRecord| Measurement {
        kind: row[0].into(),
        seconds: row[1].parse().expect("seconds"),
        mebibytes: row[2].parse().expect("mebibytes"),
        outcome: row[3].into(),
    };
    reader.records().map(|it| row(it.expect("a row"))).collect()
}

fn write(rows: &[Measurement]) {
    let mut writer = csv::Writer::from_path(FILE).expect("a file");
    writer.write_record(HEADER).expect("a header");
    for row in rows {
        let [seconds, mebibytes] = [
            format!("{:.2}", row.seconds),
            format!("{:.0}", row.mebibytes),
        ];
        writer
            .write_record([&row.kind, &seconds, &mebibytes, &row.outcome])
            .expect("a row");
    }
    writer.flush().expect("a file");
}

#[test]
fn the_table_has_each_kind_within_the_bounds() {
    let rows = committed();
    let kinds = kinds();
    assert!(kinds.len() >= 100, "{} kinds", kinds.len());
    assert_eq!(rows.len(), kinds.len());
    for (row, ((name, _), least)) in rows.iter().zip(kinds) {
        assert_eq!(row.kind, name);
        assert_eq!(why_wrong(row, least), None);
    }
}

/// Without optimisation at a tenth of the sizes, else at all of them; then what is read and refused is that of the table.
#[test]
#[ignore = "minutes: ./ci.sh tables"]
fn whole_table_no_hostile_file_takes_much_memory_or_time() {
    let divisor = if cfg!(debug_assertions) { 10 } else { 1 };
    let mut wrong = Vec::new();
    let mut rows = Vec::new();
    for ((name, _), least) in kinds() {
        match measured(&name, divisor) {
            Ok(row) => {
                wrong.extend(why_wrong(&row, least.map(|least| least / divisor)));
                rows.push(row);
            }
            Err(error) => wrong.push(error),
        }
    }
    let most = |of: fn(&Measurement) -> f64| rows.iter().map(of).fold(0.0, f64::max);
    println!(
        "{} kinds, at most {:.2} s and {:.0} MiB",
        rows.len(),
        most(|row| row.seconds),
        most(|row| row.mebibytes)
    );
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    if divisor > 1 {
        return;
    }
    if std::env::var_os("FIVEBAR_UPDATE").is_some() {
        write(&rows);
    }
    for (row, known) in rows.iter().zip(committed()) {
        let [found, known] = [row, &known].map(|it| (it.kind.clone(), it.outcome.clone()));
        assert_eq!(found, known, "FIVEBAR_UPDATE=1 writes the table anew");
    }
}
