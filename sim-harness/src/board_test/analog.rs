//! Rows of the converters: zero and noise of the currents, the bus, and which pin each code is of.

use super::bench::Bench;
use super::row::{Limit, Row, Verdict};
use crate::link::LinkError;
use fivebar_firmware::recorder::Signals;
use std::io::{Read, Write};

/// Samples of a measurement, one in each tick.
const SAMPLES: usize = 1000;
/// The code at 1.65 V, and the greatest difference of a current's zero from it.
const MIDDLE: f64 = 2048.0;
const TOLERANCE: f64 = 100.0;
/// Codes of the bus from 16.8 to 31.2 V at 11.7 mV a code.
const BUS: [f64; 2] = [1434.0, 2662.0];
/// Greatest noise [codes RMS].
const NOISE: f64 = 4.0;
/// Below this code nothing is at the pin but its pull-down.
const OFF: f64 = 100.0;

const WHERE: &str = "the zeros' tolerance (firmware/src/controller/current_zeros.rs)";
const WHERE_BUS: &str = "the benchtop arm's supply, 16.8 to 31.2 V (docs/use/wiring.md, Scales)";
const WHERE_NOISE: &str =
    "twice the 2 codes that the zeros' mean supposes (firmware/src/controller/current_zeros.rs)";

struct Channel {
    pin: &'static str,
    what: &'static str,
    level: &'static str,
    noise: &'static str,
    input: &'static str,
    range: [f64; 2],
    source: &'static str,
}

const CURRENT: [f64; 2] = [MIDDLE - TOLERANCE, MIDDLE + TOLERANCE];
const CHANNELS: [Channel; 3] = [
    Channel {
        pin: "PC0",
        what: "current 1",
        level: "current 1 offset",
        noise: "current 1 noise",
        input: "current 1 input",
        range: CURRENT,
        source: WHERE,
    },
    Channel {
        pin: "PC1",
        what: "current 4",
        level: "current 4 offset",
        noise: "current 4 noise",
        input: "current 4 input",
        range: CURRENT,
        source: WHERE,
    },
    Channel {
        pin: "PC2",
        what: "the bus voltage",
        level: "bus level",
        noise: "bus noise",
        input: "bus input",
        range: BUS,
        source: WHERE_BUS,
    },
];

/// Mean and standard deviation of each channel [codes]; none if nothing was recorded.
fn measure<L: Read + Write>(bench: &mut Bench<'_, L>) -> Result<Option<[[f64; 2]; 3]>, LinkError> {
    let signals = Signals::SENSED_1 | Signals::SENSED_4 | Signals::SENSED_OF_BOTH;
    let rows = bench.record(signals, 1, SAMPLES)?;
    if rows.is_empty() {
        return Ok(None);
    }
    Ok(Some([0, 1, 2].map(|channel| {
        let codes = rows.iter().map(|row| f64::from(row[channel]));
        let count = rows.len() as f64;
        let mean = codes.clone().sum::<f64>() / count;
        let variance = codes.map(|code| (code - mean).powi(2)).sum::<f64>() / count;
        [mean, variance.sqrt()]
    })))
}

/// Level and noise of each channel.
pub(super) fn levels<L: Read + Write>(
    bench: &mut Bench<'_, L>,
    connected: bool,
) -> Result<Vec<Row>, LinkError> {
    let measured = measure(bench)?;
    let mut rows = Vec::new();
    for (channel, place) in CHANNELS.iter().zip(0..) {
        let [least, greatest] = channel.range;
        let bound = format!("code {least:.0} to {greatest:.0}");
        let level = Limit::new(channel.level, bound, channel.source);
        let noise = Limit::new(
            channel.noise,
            format!("{NOISE:.0} codes RMS or less"),
            WHERE_NOISE,
        );
        let connect = format!(
            "connect {} to 1.65 V, or its sensor with its supply",
            channel.pin
        );
        let Some(measured) = measured.as_ref().map(|channels| channels[place]) else {
            let why = "the converters give no samples";
            rows.push(level.not_seen(why, &connect));
            rows.push(noise.not_seen(why, &connect));
            continue;
        };
        let [mean, deviation] = measured;
        if !connected && mean < OFF {
            rows.push(level.not_seen("not connected", &connect));
            rows.push(noise.not_seen("not connected", &connect));
            continue;
        }
        let why = format!("{} reads code {mean:.0}", channel.what);
        let remedy = format!(
            "measure {} with a meter: code 2048 is half of VDDA; if the voltage is right, check VDDA and VREF+",
            channel.pin
        );
        let holds = (least..=greatest).contains(&mean);
        rows.push(level.row(format!("code {mean:.1}"), Verdict::of(holds, why, remedy)));
        let why = format!("{} has noise of {deviation:.1} codes", channel.what);
        let remedy = format!(
            "check the filter at {}, the capacitors at VDDA, and the ground between sensor and chip",
            channel.pin
        );
        let verdict = Verdict::of(deviation <= NOISE, why, remedy);
        rows.push(noise.row(format!("{deviation:.2} codes RMS"), verdict));
    }
    Ok(rows)
}

/// Each pin to ground in turn: its code falls, and no other.
pub(super) fn inputs<L: Read + Write>(bench: &mut Bench<'_, L>) -> Result<Vec<Row>, LinkError> {
    let mut rows = Vec::new();
    for (channel, place) in CHANNELS.iter().zip(0..) {
        let limit = Limit::new(
            channel.input,
            format!(
                "{} to ground moves its code alone, below {OFF:.0}",
                channel.pin
            ),
            "docs/use/wiring.md, Pins",
        );
        let task = format!("Move the wire of {} from 1.65 V to ground", channel.pin);
        let Some(before) = measure(bench)?.filter(|_| bench.hands.connect(&task)) else {
            rows.push(limit.not_seen("not connected", &task));
            continue;
        };
        let after = measure(bench)?.unwrap_or(before);
        bench
            .hands
            .connect(&format!("Move the wire of {} back to 1.65 V", channel.pin));
        let moved = |other: usize| (after[other][0] - before[other][0]).abs() > TOLERANCE;
        let others: Vec<&str> = (0..CHANNELS.len())
            .filter(|&other| other != place && moved(other))
            .map(|other| CHANNELS[other].what)
            .collect();
        let fell = after[place][0] < OFF;
        let measured = format!("code {:.0} to {:.0}", before[place][0], after[place][0]);
        let (why, remedy) = match others.first() {
            Some(other) => (
                format!("{} to ground moves the code of {other}", channel.pin),
                "compare the wires of PC0, PC1 and PC2, and the sequences in firmware/src/board/stm32f405/brushed/analog.rs",
            ),
            None => (
                format!(
                    "{} to ground does not bring {} to 0",
                    channel.pin, channel.what
                ),
                "check that the wire reaches the pin",
            ),
        };
        let verdict = Verdict::of(fell && others.is_empty(), why, remedy);
        rows.push(limit.row(measured, verdict));
    }
    Ok(rows)
}
