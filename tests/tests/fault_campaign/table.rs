//! The table of the campaign as docs/verify/fault-campaign.md.

use crate::injected::{KINDS, Kind};
use crate::outcome::{Found, Outcome};
use crate::trial::{During, Trial};
use std::collections::BTreeMap;
use std::fmt::Write as _;

type All<'a> = [&'a (Trial, Outcome)];

/// The whole page.
pub(crate) fn document(trials: &[(Trial, Outcome)]) -> String {
    let seeds = trials.first().zip(trials.last());
    let (first, last) = seeds.map_or((0, 0), |(first, last)| (first.0.seed, last.0.seed));
    let mut page = format!(include_str!("head.txt"), first = first, last = last);
    for (index, kind) in KINDS.iter().enumerate() {
        let of_kind: Vec<_> = trials.iter().filter(|(t, _)| t.kind == index).collect();
        page += &row(kind, &of_kind);
    }
    page += "\n## By the state in which the fault comes\n\n";
    page += "Cells: the faults that were latched (number × times), `refused` for a refused request, – for \
             trials in which the fault was not found; then the longest time until it was found.\n\n| fault |";
    for during in During::ALL {
        let _ = write!(page, " {} |", during.name());
    }
    page += &format!("\n|{}\n", "---|".repeat(1 + During::ALL.len()));
    for (index, kind) in KINDS.iter().enumerate() {
        let _ = write!(page, "| {} |", kind.name);
        for during in During::ALL {
            let cell: Vec<_> = trials
                .iter()
                .filter(|(t, _)| t.kind == index && t.during == during)
                .collect();
            let _ = write!(page, " {} |", cell_text(&cell));
        }
        page.push('\n');
    }
    page
}

/// The row of a kind.
fn row(kind: &Kind, all: &All<'_>) -> String {
    let found: Vec<_> = all.iter().filter(|(_, o)| o.found.is_some()).collect();
    let mut times: Vec<_> = found.iter().map(|(_, o)| o.after).collect();
    times.sort_by(f64::total_cmp);
    let most = |of: fn(&Outcome) -> f64| {
        all.iter()
            .map(|(_, outcome)| of(outcome))
            .fold(0.0, f64::max)
    };
    let count = |of: fn(&Outcome) -> bool| all.iter().filter(|(_, o)| of(o)).count();
    let missed = all.len() - found.len();
    let time = match (times.get(times.len() / 2), times.last()) {
        (Some(median), Some(worst)) => {
            format!("{} / {}", milliseconds(*median), milliseconds(*worst))
        }
        _ => "–".into(),
    };
    let found_off = found.iter().map(|(_, o)| o.off).fold(0.0, f64::max);
    let found_speed = found.iter().map(|(_, o)| o.speed).fold(0.0, f64::max);
    format!(
        "| `{}` | {} | {} | {time} | {found_off:.3} | {found_speed:.1} | {:.2} | {:.2} | {:.2} | {} | {} | {} |\n",
        kind.name,
        all.len(),
        by_number(all),
        most(|o| o.current_share),
        most(|o| o.overloaded),
        most(|o| o.speed_share),
        count(Outcome::is_broken),
        count(|o| o.fell),
        if missed == 0 { "" } else { kind.unseen },
    )
}

/// What came of a kind in a state.
fn cell_text(all: &All<'_>) -> String {
    if all.is_empty() {
        return String::new();
    }
    let worst = all.iter().filter(|(_, o)| o.found.is_some());
    let worst = worst.map(|(_, o)| o.after).fold(0.0, f64::max);
    let mut text = by_number(all);
    if worst > 0.0 {
        let _ = write!(text, "; {} ms", milliseconds(worst));
    }
    text
}

/// "3 × 12, 5 × 2, – × 4".
fn by_number(all: &All<'_>) -> String {
    let mut counts: BTreeMap<(u8, &str), usize> = BTreeMap::new();
    for (_, outcome) in all {
        let key = match outcome.found {
            Some(Found::Latched(fault)) => (fault.number(), ""),
            Some(Found::Refused(_)) => (254, "refused"),
            None => (255, "–"),
        };
        *counts.entry(key).or_default() += 1;
    }
    let text = counts
        .into_iter()
        .map(|((number, word), count)| match word {
            "" => format!("{number} × {count}"),
            word => format!("{word} × {count}"),
        });
    text.collect::<Vec<_>>().join(", ")
}

/// Milliseconds with three digits.
fn milliseconds(seconds: f64) -> String {
    let ms = 1e3 * seconds;
    match ms {
        ..10.0 => format!("{ms:.1}"),
        _ => format!("{ms:.0}"),
    }
}
