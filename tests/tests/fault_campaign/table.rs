//! The table of the campaign as docs/verify/data/fault_campaign_brushed.csv.

use crate::injected::{KINDS, Kind};
use crate::outcome::{Found, Outcome};
use crate::trial::{During, Trial};
use std::collections::BTreeMap;

type All<'a> = [&'a (Trial, Outcome)];

/// The columns of the file.
const HEADING: &str = "fault,state,trials,found_by,median_ms,worst_ms,off_rad,speed_rad_s,current,overload_s,limit,\
                       broken,fell,not_found_because";

/// The whole file: of each kind a row of all its trials, and one for each state.
pub(crate) fn csv(trials: &[(Trial, Outcome)]) -> String {
    let mut file = format!("{HEADING}\n");
    for (index, kind) in KINDS.iter().enumerate() {
        let of_kind: Vec<_> = trials.iter().filter(|(t, _)| t.kind == index).collect();
        file += &row(kind, &of_kind);
        for during in During::ALL {
            let of_state = of_kind.iter().copied();
            let of_state: Vec<_> = of_state.filter(|(t, _)| t.during == during).collect();
            if !of_state.is_empty() {
                file += &state_row(kind, during, &of_state);
            }
        }
    }
    file
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
            format!("{},{}", milliseconds(*median), milliseconds(*worst))
        }
        _ => ",".into(),
    };
    let found_off = found.iter().map(|(_, o)| o.off).fold(0.0, f64::max);
    let found_speed = found.iter().map(|(_, o)| o.speed).fold(0.0, f64::max);
    format!(
        "{},all,{},{},{time},{found_off:.3},{found_speed:.1},{:.2},{:.2},{:.2},{},{},\"{}\"\n",
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
fn state_row(kind: &Kind, during: During, all: &All<'_>) -> String {
    let worst = all.iter().filter(|(_, o)| o.found.is_some());
    let worst = worst.map(|(_, o)| o.after).fold(0.0, f64::max);
    let worst = if worst > 0.0 {
        milliseconds(worst)
    } else {
        String::new()
    };
    let (name, state) = (kind.name, during.name());
    let (count, by) = (all.len(), by_number(all));
    format!("{name},{state},{count},{by},,{worst},,,,,,,,\n")
}

/// "3x12 5x2 nonex4".
fn by_number(all: &All<'_>) -> String {
    let mut counts: BTreeMap<(u8, &str), usize> = BTreeMap::new();
    for (_, outcome) in all {
        let key = match outcome.found {
            Some(Found::Latched(fault)) => (fault.number(), ""),
            Some(Found::Refused(_)) => (254, "refused"),
            None => (255, "none"),
        };
        *counts.entry(key).or_default() += 1;
    }
    let text = counts
        .into_iter()
        .map(|((number, word), count)| match word {
            "" => format!("{number}x{count}"),
            word => format!("{word}x{count}"),
        });
    text.collect::<Vec<_>>().join(" ")
}

/// Milliseconds with three digits.
fn milliseconds(seconds: f64) -> String {
    let ms = 1e3 * seconds;
    match ms {
        ..10.0 => format!("{ms:.1}"),
        _ => format!("{ms:.0}"),
    }
}
