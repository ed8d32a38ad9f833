//! The columns by kind of drive of docs/use/faults.md and docs/design/safety.md: which faults are seen is in
//! firmware/src/safety/seen.rs, how often and after which time in docs/verify/data/fault_campaign.csv.

use super::data;
use super::drives::Drive;
use super::faults::ROWS;
use super::table::{Line, short};
use fivebar_firmware::safety::{DriveKind, Fault};
use fivebar_sim::simulation::fault_name;
use std::fmt::Write as _;

/// The rows under this heading.
fn table<'a>(
    first: &str,
    columns: impl Iterator<Item = &'a str>,
    rows: impl Iterator<Item = (String, Vec<String>)>,
) -> String {
    let columns: Vec<_> = columns.collect();
    let mut text = format!("|{first}|{}|\n", columns.join("|"));
    let _ = writeln!(text, "|{}", "---|".repeat(1 + columns.len()));
    for (name, cells) in rows {
        let _ = writeln!(text, "|{name}|{}|", cells.join("|"));
    }
    text
}

/// What comes of a fault with a kind of drive.
fn seen(fault: Fault, kind: DriveKind, lines: &[Line]) -> String {
    if let Err(why) = kind.sees(fault) {
        return format!("unseen: {why}");
    }
    let of_kind = |line: &&Line| {
        let drive = Drive::ALL.into_iter().find(|it| it.name() == line.kind);
        drive.is_some_and(|drive| drive.of_controller() == kind)
    };
    let has = |line: &&Line| line.by.contains_key(&fault.number());
    let latched: Vec<_> = lines.iter().filter(of_kind).filter(has).collect();
    if latched.is_empty() {
        return "seen".into();
    }
    let times: u32 = latched.iter().map(|line| line.by[&fault.number()]).sum();
    let most = |of: fn(&Line) -> f64| latched.iter().map(|line| of(line)).fold(0.0, f64::max);
    let (after, cost) = (most(|line| line.worst_ms), most(|line| line.worst_mm));
    format!("seen: {times}, {} ms, {} mm", short(after), short(cost))
}

/// The table of these faults: those of which the same comes share a row.
fn faults(faults: impl Iterator<Item = Fault>, lines: &[Line]) -> String {
    let mut rows: Vec<(String, Vec<String>)> = Vec::new();
    for fault in faults {
        let name = format!("{} {}", fault.number(), fault_name(fault));
        let cells = DriveKind::ALL.map(|kind| seen(fault, kind, lines));
        match rows.iter_mut().find(|(_, of_row)| *of_row == cells) {
            Some((names, _)) => {
                let _ = write!(names, ", {name}");
            }
            None => rows.push((name, cells.into())),
        }
    }
    let columns = DriveKind::ALL.into_iter().map(DriveKind::name);
    table("fault", columns, rows.into_iter())
}

/// What no fault told of, though the tip was wrong by more than a tenth of the arm's leg.
fn untold(lines: &[Line]) -> String {
    let rows = ROWS.iter().filter_map(|row| {
        let cells = Drive::ALL.map(|drive| {
            let of_cell = lines
                .iter()
                .filter(|line| line.fault == row.name && line.kind == drive.name());
            let (untold, all, most) = of_cell.fold((0, 0, 0.0_f64), |(untold, all, most), line| {
                let is_untold = line.silent > 0;
                let of_line = if is_untold { line.worst_mm } else { 0.0 };
                (untold + line.silent, all + line.trials, most.max(of_line))
            });
            (untold > 0).then(|| format!("{untold} of {all}, {} mm", short(most)))
        });
        let is_told = cells.iter().all(Option::is_none);
        let texts = cells.map(|cell| cell.unwrap_or_else(|| "–".into()));
        (!is_told).then(|| (format!("`{}`", row.name), texts.into()))
    });
    table("damage", Drive::ALL.into_iter().map(Drive::name), rows)
}

/// Holds the table of this heading in a document to this one. With `FIVEBAR_UPDATE` in the environment, it is written
/// anew instead.
fn keep(document: &str, wanted: &str) {
    let path = format!("{}/../docs/{document}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).expect("a document");
    let heading = wanted.lines().next().expect("a heading");
    let start = text
        .find(heading)
        .unwrap_or_else(|| panic!("{document}: {heading}"));
    let length = text[start..]
        .find("\n\n")
        .map_or(text.len() - start, |end| end + 1);
    if std::env::var_os("FIVEBAR_UPDATE").is_some() {
        let new = [&text[..start], wanted, &text[start + length..]].concat();
        std::fs::write(path, new).expect("it can be written");
    } else {
        let hint =
            "FIVEBAR_UPDATE=1 cargo test -p fivebar-tests --test fault_campaign writes it anew";
        assert_eq!(
            &text[start..start + length],
            wanted,
            "docs/{document}: {hint}"
        );
    }
}

#[test]
fn the_documents_have_a_column_for_each_kind_of_drive_as_code_and_campaign_have_it() {
    let lines = data();
    keep("use/faults.md", &faults(Fault::all(), &lines));
    keep("design/safety.md", &untold(&lines));
}
