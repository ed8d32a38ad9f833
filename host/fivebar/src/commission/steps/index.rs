//! Homing to the encoders' index pulses, watched: how far behind its pulse each switch closes.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::record::Value;
use fivebar_firmware::Request;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::INDEX_MARGIN;
use fivebar_kinematics::five_bar::Joint;

/// Turns of the encoder from a pulse within which a switch that drifts may soon be refused.
const NEAR: f64 = 2.0 * INDEX_MARGIN as f64;
/// Error of the watched angle [turns]: samples are some milliseconds apart.
const WATCHED: f64 = 0.02;

/// What was seen of one joint while it was homed.
#[derive(Clone, Copy, Default)]
struct Seen {
    /// Its counts when its switch was last pressed.
    pressed: Option<i32>,
    /// Its counts now.
    now: i32,
    /// Whether its index output was low at any time.
    low: bool,
}

/// Homes the arm. Returns the turns of each encoder from the switch to the pulse.
pub(super) fn home(bench: &mut Bench) -> Result<Vec<Value>, StepError> {
    bench.request(Request::Home)?;
    let mut seen = [Seen::default(); 2];
    let fault = loop {
        let sample = bench.sample()?;
        for (joint, seen) in Joint::ALL.into_iter().zip(&mut seen) {
            seen.now = sample.counts[joint];
            seen.low |= !sample.index[joint];
            if sample.home[joint] {
                seen.pressed = Some(seen.now);
            }
        }
        let (status, _) = bench.client.status()?;
        match status.state {
            State::Homing => bench.client.poll()?,
            _ => break status.fault,
        }
    };
    let turns = Joint::ALL.map(|joint| {
        let turn = f64::from(bench.settings.axes[joint].index_counts);
        let gone = |from: i32| f64::from(seen[joint].now.wrapping_sub(from)).abs() / turn;
        seen[joint].pressed.map(gone)
    });
    match fault {
        None => {}
        Some(Fault::IndexAmbiguous) => return Err(ambiguous(turns)),
        Some(Fault::IndexNotFound) => return Err(not_found(turns, seen)),
        Some(fault) => return Err(StepError::Fault(fault)),
    }
    let mut values = Vec::new();
    for (joint, turns) in Joint::ALL.into_iter().zip(turns) {
        let Some(turns) = turns else { continue };
        let number = joint.number();
        if !(NEAR..=1.0 - NEAR).contains(&turns) {
            bench.report(format_args!(
                "the switch of {joint} closes {turns:.2} turns of the encoder behind the index \
                 pulse, and homing refuses less than {INDEX_MARGIN} and more than {}: better move the \
                 switch, or turn the disc, to 0.5",
                1.0 - INDEX_MARGIN
            ))?;
        }
        let name = format!("index_way{number}_turns");
        let origin = "turns of the encoder from the switch to the index pulse";
        values.push(Value::new(name, turns, origin));
    }
    Ok(values)
}

/// The joints of which this is so, in words.
fn joints(is_so: impl Fn(Joint) -> bool) -> String {
    match Joint::ALL.map(is_so) {
        [true, false] => "joint 1".into(),
        [false, true] => "joint 4".into(),
        _ => "joint 1 or joint 4".into(),
    }
}

/// Both joints search at once, so both may be near to their switches when one finds its pulse there.
fn ambiguous(turns: [Option<f64>; 2]) -> StepError {
    let margin = f64::from(INDEX_MARGIN) + WATCHED;
    let near = |turns: f64| !(margin..=1.0 - margin).contains(&turns);
    let which = joints(|joint| turns[joint].is_some_and(near));
    StepError::wrong(
        format_args!(
            "the switch of {which} closes so near to an index pulse of the encoder that it does not \
             tell this pulse from the one a turn farther"
        ),
        "move the switch, or turn the encoder's disc on its shaft, so that the switch closes half a turn of \
         the encoder behind the pulse; then correct home, the angles of the pulses",
    )
}

fn not_found(turns: [Option<f64>; 2], seen: [Seen; 2]) -> StepError {
    let which = joints(|joint| turns[joint].is_some_and(|turns| turns > 1.0));
    let high = joints(|joint| !seen[joint].low);
    if seen.iter().any(|seen| !seen.low) {
        return StepError::wrong(
            format_args!("the index output of {high} reads high all the time"),
            "check the encoder's index output and its wire to the board: a broken wire reads high; an \
             output that is low in its pulse needs an inverter",
        );
    }
    StepError::wrong(
        format_args!("no index pulse of {which} came within a turn of the encoder"),
        "check that the encoder has an index output, its wire to the board, and that its counts per \
         turn are those of the robot file",
    )
}
