//! The committed results of many repetitions, and the documents that state them.

use super::tables::Tables;
use super::{Case, Tally, identified, plates, tables};
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Repetitions of each case.
const REPETITIONS: u32 = 200;
const HEADER: &str =
    "measured,errors,accepted,refused,intervals,hold,rms_error,tip,good_left_out,wrong_kept";

/// What is measured.
#[derive(Clone, Copy)]
enum Measured {
    Plate,
    Tables(Tables),
    Log,
}

impl Measured {
    const ALL: [Self; 5] = [
        Self::Plate,
        Self::Tables(Tables::ALL[0]),
        Self::Tables(Tables::ALL[1]),
        Self::Tables(Tables::ALL[2]),
        Self::Log,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Plate => "24 holes of a plate",
            Self::Tables(tables) => tables.name(),
            Self::Log => "log of a level arm",
        }
    }

    fn tally(self, case: Case) -> Tally {
        match self {
            Self::Plate => plates::tally(case, REPETITIONS),
            Self::Tables(tables) => tables::tally(tables, case, REPETITIONS),
            Self::Log => identified::tally(false, case, REPETITIONS),
        }
    }
}

/// A row of the file.
fn row(measured: Measured, case: Case) -> String {
    let tally = measured.tally(case);
    let [tip, left_out, kept] = if matches!(measured, Measured::Log) {
        ["–".into(), "–".into(), "–".into()]
    } else {
        [
            format!("{:.2}", tally.tip()),
            tally.good_left_out.to_string(),
            tally.wrong_kept.to_string(),
        ]
    };
    format!(
        "{},{},{},{},{},{},{:.2},{tip},{left_out},{kept}\n",
        measured.name(),
        case.name(),
        tally.accepted,
        tally.refused,
        tally.intervals,
        tally.hold,
        tally.rms(),
    )
}

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../docs")
        .join(name)
}

#[test]
#[ignore = "takes minutes; scripts/soak.sh coverage writes docs/verify/data/coverage.csv with it"]
fn the_results_of_many_repetitions_are_written() {
    let sets: Vec<_> = Measured::ALL
        .into_iter()
        .flat_map(|measured| Case::ALL.map(|case| (measured, case)))
        .collect();
    let (next, rows) = (
        AtomicUsize::new(0),
        Mutex::new(vec![String::new(); sets.len()]),
    );
    thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some((measured, case)) = sets.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let row = row(*measured, *case);
                    print!("{row}");
                    let index = sets
                        .iter()
                        .position(|(m, c)| m.name() == measured.name() && c == case);
                    rows.lock().unwrap()[index.unwrap()] = row;
                }
            });
        }
    });
    let rows = rows.into_inner().unwrap().concat();
    std::fs::write(
        file("verify/data/coverage.csv"),
        format!("{HEADER}\n{rows}"),
    )
    .unwrap();
}

/// The share of the 95 % intervals that hold in a row of the file.
fn share(cells: &[&str]) -> f64 {
    let number = |text: &str| text.parse::<f64>().unwrap();
    number(cells[5]) / number(cells[4])
}

/// The least and the greatest of these numbers, as documents state them.
fn range(numbers: impl Iterator<Item = f64>, digits: usize) -> String {
    let (least, most) = numbers.fold((f64::INFINITY, 0.0_f64), |(least, most), it| {
        (least.min(it), most.max(it))
    });
    format!("{least:.digits$} to {most:.digits$}")
}

#[test]
fn the_documents_state_the_committed_coverage_which_is_near_95_percent() {
    let data = std::fs::read_to_string(file("verify/data/coverage.csv")).unwrap();
    let mut lines = data.lines();
    assert_eq!(lines.next(), Some(HEADER));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    // All cases of each kind of measurement.
    assert_eq!(rows.len(), Measured::ALL.len() * Case::ALL.len());
    let (logs, points): (Vec<_>, Vec<_>) = rows
        .iter()
        .partition(|cells| cells[0] == Measured::Log.name());
    let tips = points.iter().map(|cells| cells[7].parse::<f64>().unwrap());
    let states = |document: &str, wanted: &str| {
        let text = std::fs::read_to_string(file(document)).unwrap();
        let is_there = text.replace('\n', " ").contains(wanted);
        assert!(is_there, "docs/{document} lacks: {wanted}");
    };
    for (document, rows) in [
        ("use/calibration.md", &points),
        ("use/identification.md", &logs),
    ] {
        let shares = rows.iter().map(|cells| 1e2 * share(cells));
        states(document, &format!("{} %", range(shares, 1)));
    }
    states("use/calibration.md", &range(tips.clone(), 2));
    for cells in &rows {
        assert!((0.93..=0.97).contains(&share(cells)), "{cells:?}");
    }
    // In the mean over 200 arms the square of the tip's error has a deviation of 10 %: those with large errors count most.
    for tip in tips {
        assert!((tip - 1.0).abs() <= 0.15, "{tip}");
    }
}
