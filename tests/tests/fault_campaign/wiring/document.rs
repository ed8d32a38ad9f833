//! The page of the mistakes in the wiring, docs/use/wiring-mistakes.md, and its table,
//! docs/verify/data/wiring_mistakes.csv.

use super::trial::Found;
use crate::kinds::drives::Drive;
use fivebar_sim::simulation::fault_name;
use std::collections::BTreeMap;
use std::fmt::Write as _;

pub(crate) const DOCUMENT: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../docs/use/wiring-mistakes.md"
);
pub(crate) const TABLE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../docs/verify/data/wiring_mistakes.csv"
);

/// Why a mistake is not seen, with its letter.
const UNSEEN: [(char, &str); 5] = [
    (
        'A',
        "both joints of the simulated arm begin 0.1 rad before their switches, so each stops in its own place. Press \
         each switch by hand: `monitor --raw` shows it, and `commission` asks for it",
    ),
    (
        'B',
        "no current of this run comes near the limit. Step `electrics` of `commission` tries it",
    ),
    (
        'C',
        "the motors have this margin on this arm and with this job. With a heavier load or at a higher speed they lose steps",
    ),
    (
        'D',
        "the position loop corrects it. Weight that the arm holds, and fast jobs, show it",
    ),
    (
        'E',
        "the controller sets the mode of an ODrive itself, before it lets it give torque",
    ),
];

/// The reason for which a run does not show a mistake.
fn unseen(key: &str) -> char {
    match key {
        "switches_swapped" => 'A',
        "bridge_limit_missing" => 'B',
        "current_share" | "supply_share" => 'C',
        "torque_constant" => 'D',
        "mode_wrong" => 'E',
        _ => panic!("`{key}` is not seen: why?"),
    }
}

/// A number of two digits, or a whole one.
fn short(value: f64) -> String {
    match value {
        value if value < 0.0995 => format!("{value:.3}"),
        value if value < 0.995 => format!("{value:.2}"),
        value if value < 9.95 => format!("{value:.1}"),
        value => format!("{value:.0}"),
    }
}

/// A cell of the table.
pub(super) fn cell(key: &str, found: &Found) -> String {
    match found {
        Found::Fault {
            fault,
            after,
            is_in_job,
        } => {
            let (number, after) = (fault.number(), short(*after));
            let of_job = if *is_in_job { " of the job" } else { "" };
            format!("{number} {} after {after} s{of_job}", fault_name(*fault))
        }
        Found::Verdict { worst } => format!("verdict: {} mm", short(1e3 * worst)),
        Found::Refused(reason) => format!("ends: {}", reason.replace(',', ";")),
        Found::Drawn => format!("not seen: {}", unseen(key)),
    }
}

/// The table with these rows. A mistake is in quotation marks, because it may have a comma.
pub(super) fn table(rows: impl Iterator<Item = (String, [String; 6])>) -> String {
    let mut table = format!("mistake,{}\n", Drive::ALL.map(Drive::name).join(","));
    for (name, cells) in rows {
        let _ = writeln!(table, "{},{}", quoted(&name), cells.join(","));
    }
    table
}

/// A mistake as the table has it.
pub(super) fn quoted(name: &str) -> String {
    format!("\"{name}\"")
}

/// The cells of the row of this mistake.
pub(super) fn cells<'a>(table: &'a str, name: &str) -> Vec<&'a str> {
    let start = quoted(name) + ",";
    let row = table.lines().find_map(|line| line.strip_prefix(&start));
    let row = row.unwrap_or_else(|| panic!("no row {name}"));
    row.split(',').collect()
}

/// The page.
pub(super) fn page() -> String {
    let mut page = String::from(include_str!("head.txt"));
    page += "\nNot seen in this run, because:\n\n";
    for (letter, reason) in BTreeMap::from(UNSEEN) {
        let _ = writeln!(page, "- {letter}: {reason}.");
    }
    page
}
