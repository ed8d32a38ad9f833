//! Rows of the encoders' inputs, by a wire from the tool's output, and of the emergency stop.

use super::bench::Bench;
use super::fixture::{FIXTURE, FRAME_TICKS, PULSE_TICKS};
use super::row::{Limit, Row, Verdict};
use crate::link::LinkError;
use fivebar_firmware::Request;
use fivebar_firmware::recorder::Signals;
use fivebar_firmware::safety::Fault;
use fivebar_kinematics::five_bar::Joint;
use std::collections::BTreeMap;
use std::io::{Read, Write};

/// Rows of a recording, and ticks between them: eight pulses.
const ROWS: usize = 320;
const EVERY: u16 = 5;

/// An input: its row, its pin, its joint, and the count of a pulse while the other input is high.
const INPUTS: [(&str, &str, Joint, i16); 4] = [
    ("encoder 1 A", "PA0", Joint::Joint1, -1),
    ("encoder 1 B", "PA1", Joint::Joint1, 1),
    ("encoder 4 A", "PA15", Joint::Joint4, -1),
    ("encoder 4 B", "PB3", Joint::Joint4, 1),
];

/// What the counts of a joint did.
#[derive(PartialEq)]
enum Counts {
    Still,
    /// A step of this size and back.
    Step(i16),
    Else,
}

fn counts(rows: &[Vec<u16>], joint: Joint) -> Counts {
    let mut places = BTreeMap::new();
    for row in rows {
        *places.entry(row[joint.index()] as i16).or_insert(0_usize) += 1;
    }
    let base = places.iter().max_by_key(|(_, times)| **times);
    let Some((&base, _)) = base else {
        return Counts::Else;
    };
    let mut others = places.keys().filter(|&&place| place != base);
    match (others.next(), others.next()) {
        (None, _) => Counts::Still,
        (Some(place), None) => Counts::Step(place.wrapping_sub(base)),
        _ => Counts::Else,
    }
}

/// A pulse of PC7 at each input in turn.
pub(super) fn encoders<L: Read + Write>(
    bench: &mut Bench<'_, L>,
    settled: Result<(), &str>,
) -> Result<Vec<Row>, LinkError> {
    let mut rows = Vec::new();
    for (name, pin, joint, step) in INPUTS {
        let bound = format!("a pulse from PC7 counts {step:+} and back, at its joint alone");
        let limit = Limit::new(
            name,
            bound,
            "RM0090, encoder mode 3; the other input is pulled up",
        );
        let task = format!("Take the encoders off. Connect PC7 (the tool's output) to {pin}");
        if let Err(why) = settled {
            rows.push(limit.not_seen(why, FIXTURE));
            continue;
        }
        if !bench.hands.connect(&task) {
            rows.push(limit.not_seen("not connected", &task));
            continue;
        }
        let log = bench.record(Signals::COUNTS_1 | Signals::COUNTS_4, EVERY, ROWS)?;
        if log.is_empty() {
            rows.push(limit.not_seen("the controller records nothing", super::bench::LATER));
            continue;
        }
        let (own, other) = (counts(&log, joint), counts(&log, joint.other()));
        let wrong = |why: String| {
            let remedy = "check the wire to this pin, then the pin's solder joint and the table of pins in \
                          docs/use/wiring.md";
            Verdict::failed(why, remedy)
        };
        let (measured, verdict) = match (own, other) {
            (Counts::Step(found), Counts::Still) if found == step => {
                (format!("{found:+} and back"), Verdict::Passed)
            }
            (Counts::Step(found), Counts::Still) => {
                let why = "the pulse counts in the other direction: A and B of this encoder are exchanged";
                (format!("{found:+} and back"), wrong(why.into()))
            }
            (Counts::Still, Counts::Still) => (
                "no count".into(),
                wrong(format!("no pulse arrives at {pin}: this phase is dead")),
            ),
            (Counts::Still, _) => (
                "no count".into(),
                wrong("the pulse counts at the other joint: the encoders are exchanged".into()),
            ),
            _ => (
                "other counts".into(),
                wrong(format!(
                    "the counts are not those of a pulse of {} ms every {} ms",
                    PULSE_TICKS / 10,
                    FRAME_TICKS / 10
                )),
            ),
        };
        rows.push(limit.row(measured, verdict));
    }
    Ok(rows)
}

/// Ticks within which a change at the stop's pin must show.
const STOP_TICKS: u32 = 200;

/// The emergency stop reads released, then pressed with its fault, then released again.
pub(super) fn stop<L: Read + Write>(
    bench: &mut Bench<'_, L>,
    connected: bool,
) -> Result<Row, LinkError> {
    let limit = Limit::new(
        "emergency stop",
        "PB12 open: pressed, fault 10; to ground: released",
        "docs/use/wiring.md, Pins",
    );
    let to_ground = "connect PB12 to ground, or the emergency stop, released";
    if !connected {
        return Ok(limit.not_seen("not connected", to_ground));
    }
    let _ = bench.request(Request::ClearFault)?;
    if bench.sample()?.emergency_stop {
        let why = "the input reads pressed although it is connected to ground";
        return Ok(limit.row("pressed", Verdict::failed(why, to_ground)));
    }
    if !bench
        .hands
        .connect("Take the wire off PB12 (press the emergency stop)")
    {
        return Ok(limit.not_seen("not connected", "take the wire off PB12 when asked"));
    }
    bench.pass(STOP_TICKS)?;
    let pressed = bench.sample()?.emergency_stop;
    let fault = bench.status()?.fault;
    let back = bench
        .hands
        .connect("Connect PB12 to ground again (release the emergency stop)");
    bench.pass(STOP_TICKS)?;
    let released = !bench.sample()?.emergency_stop;
    let _ = bench.request(Request::ClearFault)?;
    let remedy = "check the wire to PB12 and the pin; do not go on before it works";
    let verdict = if !pressed {
        Verdict::failed(
            "the input does not read pressed without its wire: it is stuck",
            remedy,
        )
    } else if fault != Some(Fault::EmergencyStop) {
        Verdict::failed(
            "the input reads pressed, and fault 10 is not latched",
            remedy,
        )
    } else if back && !released {
        Verdict::failed("the input stays pressed with its wire back", remedy)
    } else {
        Verdict::Passed
    };
    let word = |pressed: bool| if pressed { "pressed" } else { "released" };
    let measured = format!("open: {}; to ground: {}", word(pressed), word(!released));
    Ok(limit.row(measured, verdict))
}
