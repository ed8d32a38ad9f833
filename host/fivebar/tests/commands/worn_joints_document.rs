//! Compares docs/design/worn-joints.md with the output of its first command: all digits where the
//! motion is regular, approximately where it is chaotic.

use fivebar_testkit::program;
use serde_json::Value;

const DOCUMENT: &str = include_str!("../../../../docs/design/worn-joints.md");

/// A row of the table: its value in a run's JSON, and the tolerated difference.
struct Row {
    name: &'static str,
    figure: fn(&Value) -> f64,
    bound: Bound,
}

enum Bound {
    /// The document's value is the run's, rounded.
    Rounded,
    /// For worn joints, whose motion is chaotic, the value may differ by this share on another
    /// machine. For new joints it is the run's, rounded.
    Chaotic(f64),
}

fn number(run: &Value, [section, key]: [&str; 2]) -> f64 {
    run[section][key].as_f64().unwrap()
}

fn each(run: &Value, key: &str) -> impl Iterator<Item = f64> {
    let list = run[key].as_array().unwrap();
    list.iter().map(|figure| figure.as_f64().unwrap())
}

fn greatest(run: &Value, key: &str) -> f64 {
    each(run, key).fold(0.0, f64::max)
}

const ROWS: [Row; 11] = [
    Row {
        name: "tip error, RMS",
        figure: |run| number(run, ["tip_error", "rms_m"]),
        bound: Bound::Chaotic(0.5),
    },
    Row {
        name: "tip error, greatest",
        figure: |run| number(run, ["tip_error", "max_m"]),
        bound: Bound::Chaotic(0.5),
    },
    Row {
        name: "by the pins, RMS",
        figure: |run| number(run, ["pin_error", "rms_m"]),
        bound: Bound::Chaotic(0.2),
    },
    Row {
        name: "by the pins, greatest",
        figure: |run| number(run, ["pin_error", "max_m"]),
        bound: Bound::Chaotic(0.5),
    },
    Row {
        name: "predicted, pins seated",
        figure: |run| number(run, ["predicted", "seated_m"]),
        bound: Bound::Rounded,
    },
    Row {
        name: "predicted, worst case",
        figure: |run| number(run, ["predicted", "worst_m"]),
        bound: Bound::Rounded,
    },
    Row {
        name: "peak torque",
        figure: |run| greatest(run, "peak_torque_nm"),
        bound: Bound::Chaotic(0.5),
    },
    Row {
        name: "peak reaction",
        figure: |run| greatest(run, "peak_reaction_n"),
        bound: Bound::Chaotic(0.5),
    },
    Row {
        name: "predicted, by inertia",
        figure: |run| greatest(&run["predicted"], "peak_reaction_n"),
        bound: Bound::Rounded,
    },
    Row {
        name: "impacts, all joints",
        figure: |run| each(run, "impacts").sum(),
        bound: Bound::Chaotic(0.2),
    },
    Row {
        name: "fastest",
        figure: |run| greatest(run, "fastest_impact_m_s"),
        bound: Bound::Chaotic(0.5),
    },
];

/// A cell of the table in SI units, and half a unit of its last digit.
fn read(cell: &str) -> (f64, f64) {
    let (number, unit) = cell.split_once(' ').unwrap_or((cell, ""));
    let scale = match unit {
        "" | "N" => 1.0,
        "mN·m" | "mm/s" => 1e-3,
        "µm" => 1e-6,
        other => panic!("unknown unit {other}"),
    };
    let decimals = number.split_once('.').map_or(0, |(_, after)| after.len());
    let half = 0.5 * 0.1_f64.powi(decimals as i32);
    (number.parse::<f64>().unwrap() * scale, half * scale)
}

/// The cells of the row of this name: new, then with increasing wear.
fn cells(name: &str) -> Vec<&'static str> {
    let row = DOCUMENT
        .lines()
        .find_map(|line| line.strip_prefix(&format!("| {name} | ")))
        .unwrap_or_else(|| panic!("no row `{name}`"));
    row.trim_end_matches(" |").split(" | ").collect()
}

#[test]
fn the_table_is_what_the_first_command_prints() {
    let folder = tempfile::tempdir().unwrap();
    let output = program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["clearance", "benchtop", "--radius", "5e-6,10e-6,20e-6"])
        .args(["--json", "--out"])
        .arg(folder.path())
        .output()
        .unwrap();
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    let runs = answer["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 4);
    for Row {
        name,
        figure,
        bound,
    } in &ROWS
    {
        let cells = cells(name);
        assert_eq!(cells.len(), runs.len(), "{name}");
        for (index, (cell, run)) in cells.iter().zip(runs).enumerate() {
            let found = figure(run);
            if *cell == "–" {
                assert_eq!(found, 0.0, "{name}: the document has no value");
                continue;
            }
            let (written, half) = read(cell);
            let off = match bound {
                Bound::Chaotic(share) if index > 0 => share * written,
                // A zero has no digits to round.
                _ if written == 0.0 => 1e-9,
                _ => 1.0001 * half,
            };
            assert!(
                (found - written).abs() <= off,
                "{name}, column {index}: {found:e} for {cell}"
            );
        }
    }
    for (cell, run) in cells("time in flight").iter().zip(runs).skip(1) {
        let (least, most) = cell.trim_end_matches(" %").split_once('…').unwrap();
        let [least, most] = [least, most].map(|share| 0.01 * share.parse::<f64>().unwrap());
        for share in each(run, "flight_share") {
            let about = least - 0.05..=most + 0.05;
            assert!(about.contains(&share), "{share} in flight for {cell}");
        }
    }
}
