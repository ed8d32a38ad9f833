//! The step that puts a voltage on one motor at a time: current sensors and directions.

use super::super::bench::{Bench, Pulse};
use super::super::finding::StepError;
use super::super::log::LogRows;
use super::super::record::Value;
use super::Outcome;
use fivebar_firmware::recorder::Signals;
use fivebar_kinematics::five_bar::Joint;
use std::f64::consts::TAU;

/// Shares of the continuous current that are tried one after the other until a joint moves.
const SHARES: [f64; 4] = [0.2, 0.4, 0.7, 0.95];
/// Travel at which a joint has moved [rad], and at which a pulse ends.
const MOVED: f64 = 0.02;
const PULSE_TRAVEL: f64 = 0.1;

fn range(values: &[f64]) -> f64 {
    let last = values.last().copied().unwrap_or(0.0);
    last - values.first().copied().unwrap_or(0.0)
}

/// Current sensors and directions of both motors.
pub(in super::super) fn directions(bench: &mut Bench) -> Result<Outcome, StepError> {
    let mut values = Vec::new();
    for joint in Joint::ALL {
        let drive = bench.drive(joint)?;
        let mut done = false;
        for share in SHARES {
            let volts = share * drive.continuous_current * drive.resistance;
            let (rows, _) = bench.excite(&Pulse {
                joint,
                volts: [volts, 0.0],
                time: 0.15,
                travel: PULSE_TRAVEL,
                current: drive.continuous_current,
                signals: Signals::COUNTS_1
                    | Signals::COUNTS_4
                    | Signals::SENSED_1
                    | Signals::SENSED_4
                    | [Signals::TOLD_1, Signals::TOLD_4][joint],
                every: 1,
            })?;
            let last = share == SHARES[SHARES.len() - 1];
            if judge_pulse(bench, joint, &rows, last)? {
                let name = format!("moving_share{}", joint.number());
                let origin = "share of the continuous current at which the joint moved";
                values.push(Value::new(name, share, origin));
                done = true;
                break;
            }
        }
        if !done {
            return Err(StepError::other("the last pulse was not judged"));
        }
    }
    let found = "each voltage gives a current in its own sensor and turns its own joint forwards";
    Ok(Outcome::new(found, values))
}

/// The mean change of a joint's current from that before the pulse, while there is a duty [A].
fn current_change(bench: &Bench, joint: Joint, rows: &LogRows, duties: &[f64]) -> f64 {
    let codes = rows.current_codes(joint);
    let zero = codes.iter().take(15).sum::<f64>() / 15.0;
    let driven = codes
        .iter()
        .zip(duties)
        .skip(20)
        .filter(|(_, duty)| **duty != 0.0);
    let changes: Vec<f64> = driven.map(|(code, _)| code - zero).collect();
    let early = changes.len().clamp(1, 30);
    let mean = changes.iter().take(early).sum::<f64>() / early as f64;
    mean * f64::from(bench.settings.axes[joint].current_per_code)
}

/// Whether the joint has moved, as it should. With `last` it should have moved.
fn judge_pulse(bench: &Bench, joint: Joint, rows: &LogRows, last: bool) -> Result<bool, StepError> {
    let mut turned = [0.0; 2];
    for (index, turned) in Joint::ALL.into_iter().zip(&mut turned) {
        *turned = range(&rows.counts(index)) * TAU / bench.counts_per_turn(index)?;
    }
    let duties = rows.duties(joint);
    let currents = Joint::ALL.map(|index| current_change(bench, index, rows, &duties));
    let drive = bench.drive(joint)?;
    let applied = duties.iter().fold(0.0_f64, |most, duty| most.max(*duty));
    let expected = applied * bench.robot.supply.voltage / drive.resistance;
    let (own, other) = (currents[joint], currents[joint.other()]);
    let moved = turned.map(|turned| turned.abs() > MOVED);
    if own < -0.3 * expected {
        return Err(StepError::wrong(
            format_args!(
                "the current sense of {joint} is reversed: a positive voltage reads {own:.2} A"
            ),
            "exchange the current sensor's ends, or the motor's current path through it",
        ));
    }
    if own.abs() < 0.3 * expected && other.abs() > 0.3 * expected {
        return Err(StepError::wrong(
            format_args!(
                "the current sensors are swapped: the bridge of {joint} shows in the other one"
            ),
            "exchange the current sensors' wires to the board",
        ));
    }
    if own.abs() < 0.3 * expected {
        if moved[0] || moved[1] {
            return Err(StepError::wrong(
                format_args!(
                    "the current sensor of {joint} is dead: its motor turns and it reads no current"
                ),
                "check the sensor's supply and its wire to the board",
            ));
        }
        if last {
            return Err(StepError::wrong(
                format_args!(
                    "the motor channel of {joint} is dead: {:.1} V give no current",
                    applied * bench.robot.supply.voltage
                ),
                "check the motor's leads, the bridge's supply and its enable wire",
            ));
        }
        return Ok(false);
    }
    if moved[joint.other()] && turned[joint.other()].abs() > 2.0 * turned[joint].abs() {
        return Err(StepError::wrong(
            format_args!(
                "the motors are swapped: the bridge of {joint} turns {}",
                joint.other()
            ),
            "exchange the motors' plugs at the bridges",
        ));
    }
    if !moved[joint] {
        if last {
            return Err(StepError::wrong(
                format_args!("{joint} does not move at its motor's continuous current"),
                "release the brake, check that gear and joint turn freely, and check \
                 continuous_current and the encoder",
            ));
        }
        return Ok(false);
    }
    // counts_per_turn has the sign of the gear ratio, so a motor turns its joint forwards.
    let forwards = turned[joint] * drive.gear_ratio.signum();
    if forwards < 0.0 {
        return Err(StepError::wrong(
            format_args!("the motor of {joint} is reversed: a positive voltage turns it backwards"),
            "exchange the motor's two leads",
        ));
    }
    Ok(true)
}
