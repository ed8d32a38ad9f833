//! What came of the trials: the lines of docs/verify/data/fault_campaign.csv, and of them the table
//! fault_campaign_by_kind.csv beside it and docs/verify/fault-campaign.md.

use super::drives::Drive;
use super::faults::{During, Not, ROWS, Row};
use super::trial::{Outcome, Trial};
use std::collections::BTreeMap;
use std::fmt::Write as _;

const HEADING: &str = "fault,kind,state,trials,found,refused,not_found,found_by,worst_ms,worst_mm,not_drawn,\
                       far_seen_by_verdict_only,far_with_status_0_unnamed";

/// What came of a fault of a kind of drive in a state.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Line {
    pub(crate) fault: String,
    pub(crate) kind: String,
    pub(crate) state: String,
    pub(crate) trials: u32,
    pub(crate) found: u32,
    pub(crate) refused: u32,
    pub(crate) not_found: u32,
    /// How often each number was latched.
    pub(crate) by: BTreeMap<u8, u32>,
    pub(crate) worst_ms: f64,
    pub(crate) worst_mm: f64,
    pub(crate) not_drawn: u32,
    pub(crate) silent: u32,
    pub(crate) unnamed: u32,
}

/// The lines of these trials, in the order of the faults, the kinds and the states.
pub(crate) fn lines(trials: &[(Trial, Outcome)]) -> Vec<Line> {
    let mut lines = BTreeMap::<_, Line>::new();
    for (trial, outcome) in trials {
        let key = (trial.row, trial.drive, trial.during);
        let line = lines.entry(key).or_insert_with(|| Line {
            fault: ROWS[trial.row].name.into(),
            kind: Drive::ALL[trial.drive].name().into(),
            state: trial.during.name().into(),
            ..Line::default()
        });
        line.add(outcome);
    }
    lines.into_values().collect()
}

impl Line {
    fn add(&mut self, outcome: &Outcome) {
        self.trials += 1;
        if let Some((fault, after)) = outcome.latched {
            self.found += 1;
            *self.by.entry(fault.number()).or_default() += 1;
            self.worst_ms = self.worst_ms.max(1e3 * after);
        } else if outcome.refused {
            self.refused += 1;
        } else {
            self.not_found += 1;
        }
        self.worst_mm = self.worst_mm.max(1e3 * outcome.worst);
        self.not_drawn += u32::from(!outcome.is_drawn);
        self.silent += u32::from(outcome.is_silent());
        self.unnamed += u32::from(outcome.is_unnamed());
    }

    fn text(&self) -> String {
        let by: Vec<_> = self
            .by
            .iter()
            .map(|(number, count)| format!("{number}x{count}"))
            .collect();
        format!(
            "{},{},{},{},{},{},{},{},{:.1},{:.2},{},{},{}\n",
            self.fault,
            self.kind,
            self.state,
            self.trials,
            self.found,
            self.refused,
            self.not_found,
            by.join(" "),
            self.worst_ms,
            self.worst_mm,
            self.not_drawn,
            self.silent,
            self.unnamed,
        )
    }

    /// A line of the file.
    fn parse(text: &str) -> Option<Self> {
        let mut cells = text.split(',');
        let mut next = || cells.next();
        let [fault, kind, state] = [next()?, next()?, next()?].map(String::from);
        let mut count = || next()?.parse().ok();
        let [trials, found, refused, not_found] = [count()?, count()?, count()?, count()?];
        let by = next()?.split_whitespace().map(|pair| {
            let (number, count) = pair.split_once('x')?;
            Some((number.parse().ok()?, count.parse().ok()?))
        });
        let by = by.collect::<Option<_>>()?;
        let [worst_ms, worst_mm] = [next()?.parse().ok()?, next()?.parse().ok()?];
        let mut count = || next()?.parse().ok();
        let line = Self {
            fault,
            kind,
            state,
            trials,
            found,
            refused,
            not_found,
            by,
            worst_ms,
            worst_mm,
            not_drawn: count()?,
            silent: count()?,
            unnamed: count()?,
        };
        next().is_none().then_some(line)
    }
}

/// The file of these lines.
pub(crate) fn csv(lines: &[Line]) -> String {
    let texts = lines.iter().map(Line::text);
    format!("{HEADING}\n{}", texts.collect::<String>())
}

/// The lines of a file.
pub(crate) fn parse(csv: &str) -> Vec<Line> {
    let mut texts = csv.lines();
    assert_eq!(texts.next(), Some(HEADING));
    texts
        .map(|text| Line::parse(text).unwrap_or_else(|| panic!("{text}")))
        .collect()
}

/// Why a fault is not seen, where it is not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unseen {
    OpenLoop,
    NotUsed,
    Small,
    TooLate,
    Distorted,
}

impl Unseen {
    const ALL: [Self; 5] = [
        Self::OpenLoop,
        Self::NotUsed,
        Self::Small,
        Self::TooLate,
        Self::Distorted,
    ];

    fn of(fault: &str, drive: Drive) -> Self {
        match fault {
            "emergency_stop_welded"
            | "contactor_welded"
            | "brake_late"
            | "brake_fails"
            | "switch_stuck"
            | "bus_sensor_stuck" => Self::NotUsed,
            "torque_constant" => Self::Small,
            "encoder_jump" | "encoder_gain" | "coupling_slips" => Self::Distorted,
            _ if !drive.is_measured() => Self::OpenLoop,
            "motor_disconnected"
            | "motor_stalled"
            | "tool_caught"
            | "brake_stuck"
            | "encoder_dead"
            | "encoder_channel_stuck"
            | "phase_open"
            | "duty_stuck"
            | "bridge_one_direction" => Self::TooLate,
            _ => Self::Small,
        }
    }

    fn letter(self) -> char {
        match self {
            Self::OpenLoop => 'P',
            Self::NotUsed => 'Q',
            Self::Small => 'R',
            Self::TooLate => 'S',
            Self::Distorted => 'T',
        }
    }

    fn reason(self) -> &'static str {
        match self {
            Self::OpenLoop => {
                "nothing measures the joint: the tip shows it, and in a simulation the verdict"
            }
            Self::NotUsed => "the part is not asked in a run, or reads what it should",
            Self::Small => "so small, or so short, that the drive carries it",
            Self::Distorted => {
                "nothing else measures the joint, so the path is distorted; or it hardly differs"
            }
            Self::TooLate => "the arm rests, or needs the part no more before the job ends",
        }
    }
}

/// The cell of a fault and a kind of drive.
pub(crate) fn cell(row: &Row, drive: Drive, lines: &[Line]) -> String {
    if let Some(not) = row.not(drive) {
        return format!("not: {}", not.letter());
    }
    let of_cell: Vec<_> = lines
        .iter()
        .filter(|line| line.fault == row.name && line.kind == drive.name())
        .collect();
    let sum = |of: fn(&Line) -> u32| of_cell.iter().map(|line| of(line)).sum::<u32>();
    let most = |of: fn(&Line) -> f64| of_cell.iter().map(|line| of(line)).fold(0.0, f64::max);
    let mut by: Vec<_> = of_cell
        .iter()
        .flat_map(|line| line.by.keys().copied())
        .collect();
    by.sort_unstable();
    by.dedup();
    let mut parts: Vec<_> = Vec::new();
    if !by.is_empty() {
        let numbers: Vec<_> = by.iter().map(u8::to_string).collect();
        parts.push(format!(
            "{}; {} ms",
            numbers.join(" "),
            short(most(|line| line.worst_ms))
        ));
    }
    if sum(|line| line.refused) > 0 {
        parts.push("refused".into());
    }
    let unseen = sum(|line| line.not_found);
    if unseen > 0 {
        let letter = Unseen::of(row.name, drive).letter();
        parts.push(format!("{letter} {unseen}/{}", sum(|line| line.trials)));
    }
    assert!(!parts.is_empty(), "{} has no trial on {drive:?}", row.name);
    format!(
        "{}; {} mm",
        parts.join("; "),
        short(most(|line| line.worst_mm))
    )
}

/// Two digits.
pub(crate) fn short(value: f64) -> String {
    if value < 10.0 {
        format!("{value:.1}")
    } else {
        format!("{value:.0}")
    }
}

/// The table of these lines: for each fault a cell for each kind of drive.
pub(crate) fn by_kind(lines: &[Line]) -> String {
    let mut table = format!("fault,{}\n", Drive::ALL.map(Drive::name).join(","));
    for row in ROWS {
        let cells = Drive::ALL.map(|drive| cell(row, drive, lines));
        let _ = writeln!(table, "{},{}", row.name, cells.join(","));
    }
    table
}

/// The page of these lines.
pub(crate) fn document(lines: &[Line]) -> String {
    let sum = |of: fn(&Line) -> u32| lines.iter().map(of).sum::<u32>();
    let mut page = format!(
        include_str!("head.txt"),
        trials = sum(|line| line.trials),
        found = sum(|line| line.found),
        refused = sum(|line| line.refused),
        not_found = sum(|line| line.not_found),
        silent = sum(|line| line.silent),
        unnamed = sum(|line| line.unnamed),
    );
    page += "Not injected (not), because:\n\n";
    for not in Not::ALL {
        let _ = writeln!(page, "- {}: {}", not.letter(), not.reason());
    }
    page += "\nNot seen in so many of the trials, because:\n\n";
    for unseen in Unseen::ALL {
        let _ = writeln!(page, "- {}: {}", unseen.letter(), unseen.reason());
    }
    page +=
        "\n## By the state in which the fault comes\n\nFound or refused, of all trials:\n\n|state|";
    for drive in Drive::ALL {
        let _ = write!(page, "{}|", drive.name());
    }
    page += &format!("\n|{}\n", "---|".repeat(1 + Drive::ALL.len()));
    for during in During::ALL {
        let _ = write!(page, "|{}|", during.name());
        for drive in Drive::ALL {
            let of_cell = lines
                .iter()
                .filter(|line| line.state == during.name() && line.kind == drive.name());
            let (seen, all) = of_cell.fold((0, 0), |(seen, all), line| {
                (seen + line.found + line.refused, all + line.trials)
            });
            let _ = write!(page, "{seen}/{all}|");
        }
        page.push('\n');
    }
    page
}
