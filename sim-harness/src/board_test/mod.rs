//! The test of a bare board without motors: what only silicon can show, row by row.

mod analog;
mod bench;
mod digital;
mod ends;
mod fixture;
mod load;
mod row;
mod start;

use crate::link::{Client, LinkError};
use bench::Bench;
pub use bench::Hands;
use fivebar_firmware::protocol::{Identity, Timing};
pub use fixture::{bare_settings, small_move};
pub use row::{Row, Verdict};
use serde::Serialize;
use std::io::{Read, Write};

/// The last words of the number of the simulated chip of verify/chip: `ivebar-1`.
const SIMULATED: [u32; 2] = [u32::from_le_bytes(*b"iveb"), u32::from_le_bytes(*b"ar-1")];

/// The rows that need the crystal: without it no PWM starts the converters.
const NEED_CRYSTAL: [&str; 19] = [
    "current 1 offset",
    "current 1 noise",
    "current 4 offset",
    "current 4 noise",
    "bus level",
    "bus noise",
    "interrupt",
    "response",
    "missed ticks",
    "stack",
    "response while saving",
    "current 1 input",
    "current 4 input",
    "bus input",
    "encoder 1 A",
    "encoder 1 B",
    "encoder 4 A",
    "encoder 4 B",
    "emergency stop",
];

/// Why a board was not tested.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BoardTestError {
    /// The connection failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The board has no parts of its own to test.
    #[error(
        "this board cannot test itself: it is emulated, or its firmware is older than this program; flash the \
         image `stm32f405` of this release"
    )]
    NoTest,
}

/// The times of the ticks on a path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TickTimes {
    /// Of the interrupt [cycles].
    pub interrupt: Histogram,
    /// From the start of the converters to the last output [cycles].
    pub response: Histogram,
}

/// Times of ticks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Histogram {
    /// The shortest.
    pub least: u32,
    /// The mean.
    pub mean: f64,
    /// The longest.
    pub greatest: u32,
    /// The number of ticks.
    pub ticks: u32,
    /// Width of a bin.
    pub bin: u32,
    /// Ticks in each bin, from 0 on.
    pub bins: [u32; fivebar_firmware::protocol::TIMING_BINS],
}

impl Histogram {
    fn new(timing: &Timing) -> Self {
        Self {
            least: timing.least,
            mean: timing.mean().unwrap_or_default(),
            greatest: timing.greatest,
            ticks: timing.ticks,
            bin: fivebar_firmware::protocol::TIMING_BIN,
            bins: timing.bins,
        }
    }
}

/// The report of a board's test.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BoardReport {
    /// The firmware's version.
    pub firmware: String,
    /// The chip's number.
    pub unique_id: String,
    /// Whether the chip is the simulated one: its times are instructions, not cycles.
    pub simulated: bool,
    /// The unit of the ticks' times.
    pub unit: &'static str,
    /// The rows.
    pub rows: Vec<Row>,
    /// The times of the ticks on a path, if there was one.
    pub times: Option<TickTimes>,
}

impl BoardReport {
    /// The rows that have failed.
    pub fn failed(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| row.verdict.is_failed())
    }
}

/// Tests the board for which this client has begun a session; it follows a path for so many `seconds`.
/// Afterwards the watchdog has reset it, so it runs with the settings that it had stored.
///
/// # Errors
/// The connection failed, or the board has no test.
pub fn run<L: Read + Write>(
    client: &mut Client<L>,
    identity: &Identity,
    hands: &mut dyn Hands,
    seconds: f64,
) -> Result<BoardReport, BoardTestError> {
    let mut bench = Bench { client, hands };
    let facts = bench.facts()?.ok_or(BoardTestError::NoTest)?;
    let [_, simulated @ ..] = facts.unique_id;
    let simulated = simulated == SIMULATED;
    let unit = match simulated {
        true => "cycles of the simulated chip (instructions, not cycles)",
        false => "cycles",
    };
    let mut rows = Rows(Vec::new());
    let connected = bench.hands.connect(fixture::FIXTURE);
    rows.add(
        &mut bench,
        [
            start::crystal(&facts),
            start::accelerator(&facts),
            start::size(&facts),
        ],
    );
    let row = start::tick_period(&mut bench)?;
    rows.add(&mut bench, [row]);
    let times = if start::runs_from_crystal(&facts) {
        on_crystal(&mut bench, &mut rows, connected, seconds, unit)?
    } else {
        rows.add(&mut bench, NEED_CRYSTAL.map(start::needs_crystal));
        None
    };
    let row = ends::serial(&bench, simulated);
    rows.add(&mut bench, [row]);
    let found = ends::flash(&mut bench, &facts)?;
    rows.add(&mut bench, found);
    let found = ends::watchdog(&mut bench, &facts)?;
    rows.add(&mut bench, found);
    let [major, minor, patch] = identity.firmware;
    Ok(BoardReport {
        firmware: format!("{major}.{minor}.{patch}"),
        unique_id: facts.unique_id.map(|word| format!("{word:08x}")).concat(),
        simulated,
        unit,
        rows: rows.0,
        times: times.map(|[interrupt, response]| TickTimes {
            interrupt: Histogram::new(&interrupt),
            response: Histogram::new(&response),
        }),
    })
}

/// The rows that need the crystal, and the ticks' times on a path.
fn on_crystal<L: Read + Write>(
    bench: &mut Bench<'_, L>,
    rows: &mut Rows,
    connected: bool,
    seconds: f64,
    unit: &str,
) -> Result<Option<[Timing; 2]>, LinkError> {
    let found = analog::levels(bench, connected)?;
    rows.add(bench, found);
    let settled = match connected {
        true => load::settle(bench)?,
        false => Err("not connected".into()),
    };
    let settled = settled.as_ref().copied().map_err(String::as_str);
    let load = load::ticks(bench, settled, seconds, unit)?;
    rows.add(bench, load.rows);
    let row = load::saving(bench, unit)?;
    rows.add(bench, [row]);
    let found = analog::inputs(bench)?;
    rows.add(bench, found);
    let found = digital::encoders(bench, settled)?;
    rows.add(bench, found);
    let row = digital::stop(bench, connected)?;
    rows.add(bench, [row]);
    Ok(load.times)
}

/// The rows so far.
struct Rows(Vec<Row>);

impl Rows {
    /// Adds rows, and reports each.
    fn add<L>(&mut self, bench: &mut Bench<'_, L>, rows: impl IntoIterator<Item = Row>) {
        for row in rows {
            let Row { name, measured, .. } = &row;
            let word = row.verdict.word();
            let mut line = format!("{name}: {word}");
            if !measured.is_empty() {
                line += &format!(", {measured}");
            }
            if let Some((why, remedy)) = row.verdict.reason() {
                line += &format!(": {why}. To do: {remedy}.");
            }
            bench.hands.report(&line);
            self.0.push(row);
        }
    }
}
