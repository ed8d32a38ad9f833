//! The tables by kind of drive of docs/use/faults.md, docs/verify/data/seen_faults.csv and docs/design/safety.md: which
//! faults are seen is in firmware/src/safety/seen.rs, how often and after which time in docs/verify/data/fault_campaign.csv.

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
    format!("seen: {times}; {} ms; {} mm", short(after), short(cost))
}

/// The lines of docs/verify/data/seen_faults.csv: what comes of each fault with each kind of drive.
fn seen_faults(lines: &[Line]) -> String {
    let mut text = format!(
        "number,fault,{}\n",
        DriveKind::ALL.map(DriveKind::name).join(",")
    );
    for fault in Fault::all() {
        let cells = DriveKind::ALL.map(|kind| seen(fault, kind, lines));
        let (number, name) = (fault.number(), fault_name(fault));
        let _ = writeln!(text, "{number},{name},{}", cells.join(","));
    }
    text
}

/// The faults that a kind of drive does not show, as ranges of their numbers.
fn unseen(kind: DriveKind) -> String {
    let mut ranges: Vec<[u8; 2]> = Vec::new();
    for fault in Fault::all().filter(|&fault| kind.sees(fault).is_err()) {
        let number = fault.number();
        match ranges.last_mut() {
            Some([_, last]) if *last + 1 == number => *last = number,
            _ => ranges.push([number, number]),
        }
    }
    let text = |[first, last]: [u8; 2]| match last - first {
        0 => format!("{first}"),
        1 => format!("{first}, {last}"),
        _ => format!("{first} to {last}"),
    };
    ranges.into_iter().map(text).collect::<Vec<_>>().join(", ")
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
    let text = read(document);
    let heading = wanted.lines().next().expect("a heading");
    let start = text
        .find(heading)
        .unwrap_or_else(|| panic!("{document}: {heading}"));
    let length = text[start..]
        .find("\n\n")
        .map_or(text.len() - start, |end| end + 1);
    let new = [&text[..start], wanted, &text[start + length..]].concat();
    keep_whole(document, &new);
}

/// Holds a whole file to this text, or writes it anew.
fn keep_whole(document: &str, wanted: &str) {
    if std::env::var_os("FIVEBAR_UPDATE").is_some() {
        std::fs::write(path(document), wanted).expect("it can be written");
    } else {
        let hint =
            "FIVEBAR_UPDATE=1 cargo test -p fivebar-tests --test fault_campaign writes it anew";
        assert_eq!(read(document), wanted, "docs/{document}: {hint}");
    }
}

fn path(document: &str) -> String {
    format!("{}/../docs/{document}", env!("CARGO_MANIFEST_DIR"))
}

fn read(document: &str) -> String {
    std::fs::read_to_string(path(document)).expect("a document")
}

#[test]
fn the_documents_have_each_kind_of_drive_as_code_and_campaign_have_it() {
    let lines = data();
    let kinds = DriveKind::ALL.map(|kind| (kind.name().to_owned(), vec![unseen(kind)]));
    let columns = ["faults that are not seen"].into_iter();
    keep(
        "use/faults.md",
        &table("drives", columns, kinds.into_iter()),
    );
    keep_whole("verify/data/seen_faults.csv", &seen_faults(&lines));
    keep("design/safety.md", &untold(&lines));
}
