//! The table of `docs/verify/bounds.md`: printed, never retyped.

use std::fmt::Write as _;

use crate::families::{BRUSHED, FAMILIES, Family, STACK_BUDGET};
use crate::registers;
use crate::report::{Row, read};
use crate::response::{self, Driving};

/// What encloses the table in the document.
const BEGIN: &str = "<!-- printed by fivebar-bounds document -->\n";
const END: &str = "<!-- end -->\n";

/// Whole numbers with a comma at each thousand.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// The figure behind `name` in a text of lines.
fn figure(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim().split('.').next()?.parse().ok()
}

/// The table, from the committed figures: those of the bounds, what the simulated chip measured, the
/// instructions that the emulator counted, and the accesses to slow registers that the simulated chip counted. None if
/// a figure is missing.
#[expect(clippy::too_many_lines, reason = "a list of rows")]
pub fn table(chip: &str, instructions: &str, accesses: &str) -> Option<String> {
    let [first, others @ ..] = FAMILIES;
    let (_, rows) = read(first.committed);
    let row = |name: &str| -> Option<&Row> { rows.iter().find(|row| row.name == name) };
    let [tick, ..] = row("tick: tick::__cortex_m_rt_main")?.longest?;
    let of = |name: &str| row(&BRUSHED.labelled(name))?.longest;
    let [interrupt, ..] = of(BRUSHED.tick)?;
    let counted = instructions.lines().filter(|line| line.contains("tick"));
    let most_tick = counted
        .filter_map(|line| line.split_whitespace().last()?.parse().ok())
        .max()?;
    let most_interrupt = figure(chip, "tick, most [instructions]:")?;
    let most_stack = figure(chip, "stack, most [bytes]:")?;
    let [stack, space] = ["all nested", "space"].map(|name| {
        let stack = row(&BRUSHED.labelled(name)).and_then(|row| row.stack);
        stack.map(u64::from)
    });

    let mut text = String::from("| | proved | most seen in runs | limit |\n|---|---|---|---|\n");
    let mut line = |what: &str, proved: u64, unit: &str, seen: Option<u64>, limit: String| {
        let seen = seen.map_or("–".to_owned(), |seen| format!("{} {unit}", grouped(seen)));
        let _ = writeln!(
            text,
            "| {what} | {} {unit} | {seen} | {limit} |",
            grouped(proved)
        );
    };
    let none = || "–".to_owned();
    line(
        "the tick (image `tick`)",
        tick,
        "instructions",
        Some(most_tick),
        none(),
    );
    line(
        "the tick's interrupt (image `stm32f405`)",
        interrupt,
        "instructions",
        Some(most_interrupt),
        none(),
    );
    line(
        "stack, every interrupt within another one",
        stack?,
        "bytes",
        Some(most_stack),
        format!(
            "{}, of {} in the RAM",
            grouped(u64::from(STACK_BUDGET)),
            grouped(space?)
        ),
    );
    text.push_str(
        "\n| cycles | flash never waits | code waits, RAM does not | all accesses wait | limit of the second |\n|---|---|---|---|---|\n",
    );
    for (what, name) in [
        (
            "conversion, and pre-emption by the break input and the NMI",
            response::BEFORE,
        ),
        ("longest blocking by what runs below", response::BLOCKING),
        ("the tick's interrupt", BRUSHED.tick),
        ("response, the sum", response::RESPONSE),
    ] {
        let [_, never, code, all] = of(name)?.map(grouped);
        let _ = writeln!(
            text,
            "| {what} | {never} | {code} | {all} | {} |",
            grouped(BRUSHED.budget(name)?)
        );
    }
    let [_, _, code, _] = of(BRUSHED.tick)?;
    let free = BRUSHED.budget(BRUSHED.tick)?.saturating_sub(code);
    let _ = writeln!(
        text,
        "\nFree in the interrupt, with all of today's work on: {} cycles of {}.",
        grouped(free),
        grouped(BRUSHED.budget(BRUSHED.tick)?)
    );
    text.push_str(
        "\n| with the registers that wait | accesses over APB1, APB2 | cycles, at most | the tick's interrupt | limit | response | limit |\n|---|---|---|---|---|---|---|\n",
    );
    for waits in registers::counted(accesses)? {
        let [first, second] = waits.accesses;
        let [interrupt, response] = waits.bounds(&rows)?;
        let [interrupt, response] = [interrupt, response]
            .map(|(bound, limit)| format!("{} | {}", grouped(bound), grouped(limit)));
        let (label, cycles) = (waits.driving.label, grouped(waits.cycles()));
        let _ = writeln!(
            text,
            "| `{label}` | {first}, {second} | {cycles} | {interrupt} | {response} |"
        );
    }
    for family in others {
        text.push_str(&of_all_waits(family)?);
    }
    Some(text)
}

/// The images of a family whose limits hold where all accesses wait.
fn of_all_waits(family: &Family) -> Option<String> {
    let (_, rows) = read(family.committed);
    let [first, ..] = family.images else {
        return None;
    };
    let [.., period] = first.budgets;
    let labels: Vec<_> = family
        .images
        .iter()
        .map(|image| format!("`{}`", image.label))
        .collect();
    let mut text = format!(
        "\n|cycles at {} MHz, all accesses wait|{}|limit|\n|---|{}---|\n",
        period / 100,
        labels.join("|"),
        "---|".repeat(labels.len())
    );
    let [serial, ..] = first.below else {
        return None;
    };
    let mut whats = vec![
        ("the tick's interrupt", first.tick),
        ("longest blocking by what runs below", response::BLOCKING),
        ("response, the sum", response::RESPONSE),
        ("the serial line's first byte", response::RECEIVER),
        ("the serial line's interrupt", serial),
    ];
    whats.extend(first.lowest.map(|name| ("the interrupt of USB", name)));
    whats.push(("stack [bytes]", response::NESTED));
    for (what, name) in whats {
        let figure = |image: &Driving| -> Option<String> {
            let row = rows.iter().find(|row| row.name == image.labelled(name))?;
            let cycles = row.longest.map(|[.., all_wait]| all_wait);
            Some(grouped(cycles.or(row.stack.map(u64::from))?))
        };
        let limit = first.budget(name).map_or("–".to_owned(), grouped);
        let figures: Option<Vec<_>> = family.images.iter().map(figure).collect();
        let _ = writeln!(text, "|{what}|{}|{limit}|", figures?.join("|"));
    }
    Some(text)
}

/// The table in a document; none if it has no marks.
pub fn table_in(document: &str) -> Option<&str> {
    let (_, behind) = document.split_once(BEGIN)?;
    let (table, _) = behind.split_once(END)?;
    Some(table)
}
