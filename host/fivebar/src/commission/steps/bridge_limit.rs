//! The bridge's own current limit: whether it is there, and where.
//!
//! A pulse of the whole bus voltage, so short that the joint hardly moves, drives the current of a motor at
//! rest as high as its winding lets it; one pulse away from the switch, and one back. A bridge with its limit holds it between the peak current,
//! which the loops need, and the over-current, which is a fault.

use super::super::bench::{Bench, Pulse};
use super::super::finding::StepError;
use super::super::record::Value;
use super::electrics::away_from_switch;
use fivebar_firmware::controller::{LONGEST_PULSE, MOST_DUTY};
use fivebar_firmware::recorder::Signals;
use fivebar_firmware::safety::Fault;
use fivebar_kinematics::five_bar::Joint;

/// Rows at the end of the pulse whose mean is the limit.
const LAST: usize = 5;
/// Share of the current that the winding would carry, from which on it is the winding that limits.
const WINDING: f64 = 0.9;

/// Finds the limit of a bridge whose motor has this resistance [Ω]: what was found, in words and for the record.
pub(super) fn bridge_limit(
    bench: &mut Bench,
    joint: Joint,
    resistance: f64,
) -> Result<(String, Value), StepError> {
    let this = joint.number();
    let axis = &bench.settings.axes[joint];
    let peak = f64::from(axis.peak_current);
    let over_current = f64::from(bench.settings.protection.over_current);
    // What the over-current lets an excitation have.
    let volts = f64::from(MOST_DUTY) * bench.robot.supply.voltage;
    let volts = volts.min(1.99 * f64::from(axis.resistance) * over_current);
    let away = away_from_switch(bench, joint)?;
    let there = pulse_current(bench, joint, away * volts)?;
    let back = pulse_current(bench, joint, -away * volts)?;
    let current = there.min(back);
    let name = format!("pulse_current{this}_a");
    let value = Value::new(name, current, "at the end of a pulse of the whole voltage");
    if current > WINDING * volts / resistance {
        let found = format!("the winding of {joint} limits its current to {current:.2} A");
        return Ok((found, value));
    }
    if current < peak {
        return Err(StepError::wrong(
            format_args!(
                "the current limit of the bridge of {joint} is {current:.2} A, below the peak \
                 current of {peak:.2} A"
            ),
            "check VREF and the resistor at IPROPI (docs/use/wiring.md, Current limit), or lower peak_current",
        ));
    }
    let found = format!("the bridge of {joint} limits its current to {current:.2} A");
    Ok((found, value))
}

/// The current at the end of a pulse [A].
fn pulse_current(bench: &mut Bench, joint: Joint, volts: f64) -> Result<f64, StepError> {
    let over_current = f64::from(bench.settings.protection.over_current);
    let pulse = Pulse {
        joint,
        volts: [volts, 0.0],
        time: f64::from(LONGEST_PULSE),
        travel: 0.1,
        current: over_current,
        signals: [
            Signals::SENSED_1.union(Signals::TOLD_1),
            Signals::SENSED_4.union(Signals::TOLD_4),
        ][joint],
        every: 1,
    };
    let rows = match bench.excite(&pulse) {
        Ok((rows, _)) => rows,
        Err(StepError::Fault(Fault::OverCurrent)) => {
            return Err(StepError::wrong(
                format_args!(
                    "the current limit of the bridge of {joint} is missing or above \
                     {over_current:.1} A: a short pulse of {:.1} V is an over-current",
                    volts.abs()
                ),
                "fit the resistor at IPROPI and the reference at VREF that docs/use/wiring.md works out \
                 (Current limit)",
            ));
        }
        Err(other) => return Err(other),
    };
    let per_code = f64::from(bench.settings.axes[joint].current_per_code);
    let codes = rows.current_codes(joint);
    let driven: Vec<f64> = (codes.iter().zip(rows.duties(joint)))
        .filter(|(_, duty)| *duty != 0.0)
        .map(|(code, _)| ((code - bench.zeros[joint]) * per_code).abs())
        .collect();
    let last = &driven[driven.len().saturating_sub(LAST)..];
    Ok(last.iter().sum::<f64>() / last.len().max(1) as f64)
}
