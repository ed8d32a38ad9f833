//! Rows of the ticks' times: armed and on a path, with planning and telemetry; then stopped, while the
//! flash is programmed.

use super::bench::{Bench, LATER, SECOND};
use super::fixture::{ANGLES, bare_settings, small_move};
use super::row::{Limit, Row, Verdict};
use crate::link::LinkError;
use crate::simulation::fault_name;
use fivebar_firmware::protocol::{BoardTest, HostCommand, TimedSpan, Timing};
use fivebar_firmware::safety::State;
use fivebar_firmware::{Request, Status};
use std::io::{Read, Write};

/// Greatest cycles of the interrupt: 60 % of the period.
const INTERRUPT: u32 = 10_080;
/// The interrupt, and 840 cycles each for what blocks it and for conversion and pre-emption.
const RESPONSE: u32 = 11_760;
/// A period: while the flash is programmed, the core waits for up to 16 µs more at a time.
const PERIOD: u32 = 16_800;
/// Share of the stack that must stay free.
const FREE_STACK: f64 = 0.25;
/// Samples of telemetry per second, every so many ticks.
const TELEMETRY: u16 = 100;
/// Programmed in the second load, so many times.
const PROGRAMS: usize = 20;
/// Ticks after the settings are applied in which the zeros of the currents are measured.
const ZEROS: u32 = 2400;

/// The rows, and the times of the first load.
pub(super) struct Load {
    pub(super) rows: Vec<Row>,
    pub(super) times: Option<[Timing; 2]>,
}

fn shown(timing: &Timing, unit: &str) -> String {
    format!(
        "{} to {} {unit}, mean {:.0}, of {} ticks",
        timing.least,
        timing.greatest,
        timing.mean().unwrap_or_default(),
        timing.ticks
    )
}

fn timed(limit: Limit, timing: &Timing, most: u32, unit: &str) -> Row {
    let why = format!("it takes up to {} {unit}", timing.greatest);
    let remedy = "look at the row `flash accelerator`, then compare the histogram with docs/verify/bounds.md";
    let verdict = match timing.ticks {
        0 => Verdict::not_seen("the board has timed no tick", LATER),
        _ => Verdict::of(timing.greatest <= most, why, remedy),
    };
    limit.row(shown(timing, unit), verdict)
}

/// Uses the settings of a bare board; the refusal.
pub(super) fn settle<L: Read + Write>(
    bench: &mut Bench<'_, L>,
) -> Result<Result<(), String>, LinkError> {
    let _ = bench.request(Request::ClearFault)?;
    Ok(match bench.client.write_settings(&bare_settings())? {
        Ok(()) => Ok(()),
        Err(refusal) => Err(format!("the board refuses the test's settings: {refusal}")),
    })
}

/// Arms the board and follows a path for this time; the path's status at the end, or why not.
fn follow<L: Read + Write>(
    bench: &mut Bench<'_, L>,
    seconds: f64,
) -> Result<Result<u32, String>, LinkError> {
    if !bench.pass(ZEROS)? {
        return Ok(Err("no tick comes".into()));
    }
    for request in [Request::SetAngles(ANGLES), Request::Arm] {
        if let Err(refusal) = bench.request(request)? {
            let (status, cause) = (bench.status()?, refusal.to_string());
            return Ok(Err(fault_of(&status).unwrap_or(cause)));
        }
    }
    bench.pass(100)?;
    let status = bench.status()?;
    let (Some(start), State::Armed) = (status.tool, status.state) else {
        return Ok(Err(
            fault_of(&status).unwrap_or_else(|| "it does not arm".into())
        ));
    };
    let telemetry = HostCommand::Telemetry { every: TELEMETRY };
    let _ = bench.client.command(telemetry)?;
    bench.begin_timing()?;
    let (begin, missed) = (status.tick, status.missed_ticks);
    let end = (seconds * f64::from(SECOND)) as u32;
    let (mut tag, mut room) = (0, 1);
    let status = loop {
        while room > 0 {
            let next = HostCommand::Move(small_move(tag + 1, start));
            match bench.client.command(next)? {
                Ok(()) => (tag, room) = (tag + 1, room - 1),
                Err(_) => room = 0,
            }
        }
        while bench.client.take_telemetry().is_some() {}
        let (status, free) = bench.client.status()?;
        room = free;
        if status.fault.is_some() || status.tick.wrapping_sub(begin) >= end {
            break status;
        }
        if room == 0 {
            bench.client.poll()?;
        }
    };
    Ok(match fault_of(&status) {
        Some(fault) => Err(fault),
        None => Ok(status.missed_ticks.wrapping_sub(missed)),
    })
}

fn fault_of(status: &Status) -> Option<String> {
    let fault = status.fault?;
    Some(format!("fault {}: {}", fault.number(), fault_name(fault)))
}

/// The first load.
pub(super) fn ticks<L: Read + Write>(
    bench: &mut Bench<'_, L>,
    settled: Result<(), &str>,
    seconds: f64,
    unit: &str,
) -> Result<Load, LinkError> {
    let interrupt = Limit::new(
        "interrupt",
        format!("{INTERRUPT} cycles or less, armed and on a path"),
        "60 % of the period (docs/verify/bounds.md)",
    );
    let response = Limit::new(
        "response",
        format!("{RESPONSE} cycles or less, armed and on a path"),
        "the interrupt, 840 cycles of blocking, 840 of conversion and pre-emption (docs/verify/bounds.md)",
    );
    let missed = Limit::new("missed ticks", "0", "every tick is in time");
    let stack = Limit::new(
        "stack",
        "a quarter stays free",
        "docs/use/bring-up.md, Stack",
    );
    let outcome = match settled {
        Ok(()) => follow(bench, seconds)?,
        Err(why) => Err(why.into()),
    };
    let times = [
        bench.timing(TimedSpan::Interrupt)?,
        bench.timing(TimedSpan::Response)?,
    ];
    let _ = bench.client.command(HostCommand::Telemetry { every: 0 })?;
    let _ = bench.request(Request::Disarm)?;
    bench.pass(SECOND / 10)?;
    // A host that was late after its last look has left a fault that no later row is about.
    let _ = bench.request(Request::ClearFault)?;
    let used = bench.client.stack()?;
    let mut rows = match outcome {
        Ok(count) => {
            let why = format!("{count} ticks were missed");
            let verdict = Verdict::of(count == 0, why, "look at the row `response`");
            vec![
                timed(interrupt, &times[0], INTERRUPT, unit),
                timed(response, &times[1], RESPONSE, unit),
                missed.row(format!("{count} in {seconds} s"), verdict),
            ]
        }
        Err(ref why) => {
            let remedy = "connect what the first task asks for";
            [interrupt, response, missed]
                .map(|limit| limit.not_seen(why, remedy))
                .into()
        }
    };
    rows.push(match used {
        Some(used) => {
            let free = 1.0 - f64::from(used.most) / f64::from(used.size);
            let verdict = Verdict::of(
                free >= FREE_STACK,
                "the stack is nearly used",
                "compare it with tests/data/image_size.json",
            );
            stack.row(
                format!("{} of {} bytes used", used.most, used.size),
                verdict,
            )
        }
        None => stack.not_seen("the board does not measure it", LATER),
    });
    let times = outcome.is_ok().then_some(times);
    Ok(Load { rows, times })
}

/// The second load: the response while words are programmed, with telemetry.
pub(super) fn saving<L: Read + Write>(
    bench: &mut Bench<'_, L>,
    unit: &str,
) -> Result<Row, LinkError> {
    let limit = Limit::new(
        "response while saving",
        format!("{PERIOD} cycles or less, stopped"),
        "a word takes 16 µs, in which the core waits (firmware/src/board/stm32f405/storage.rs)",
    );
    let telemetry = HostCommand::Telemetry { every: TELEMETRY };
    let _ = bench.client.command(telemetry)?;
    bench.begin_timing()?;
    for _ in 0..PROGRAMS {
        if let Err(verdict) = bench.flash(BoardTest::ProgramFlash)? {
            return Ok(limit.row("", verdict));
        }
    }
    let times = bench.timing(TimedSpan::Response)?;
    let _ = bench.client.command(HostCommand::Telemetry { every: 0 })?;
    while bench.client.take_telemetry().is_some() {}
    Ok(timed(limit, &times, PERIOD, unit))
}
