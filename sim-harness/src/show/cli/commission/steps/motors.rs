//! The steps that put a voltage on one motor at a time: current sensors and directions, then
//! resistance, inductance and torque constant.

use super::super::bench::{Bench, Pulse};
use super::super::finding::StepError;
use super::super::log::LogRows;
use super::super::operator::number;
use super::super::record::Value;
use super::fit::least_squares;
use super::{Outcome, measured};
use crate::input::robot::MeasuredKey;
use fivebar_firmware::recorder::Signals;
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
    for joint in [0, 1] {
        let drive = bench.drive(joint)?;
        let mut done = false;
        for share in SHARES {
            let volts = share * drive.continuous_current * drive.resistance;
            let (rows, _) = bench.excite(&Pulse {
                joint,
                volts: [volts, 0.0],
                time: 0.15,
                travel: PULSE_TRAVEL,
                signals: Signals::COUNTS_1
                    | Signals::COUNTS_4
                    | Signals::CURRENT_1
                    | Signals::CURRENT_4
                    | [Signals::DUTY_1, Signals::DUTY_4][joint],
                every: 1,
            })?;
            let last = share == SHARES[SHARES.len() - 1];
            if judge_pulse(bench, joint, &rows, last)? {
                let name = format!("moving_share{}", number(joint));
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

/// Whether the joint has moved, as it should. With `last` it should have moved.
fn judge_pulse(bench: &Bench, joint: usize, rows: &LogRows, last: bool) -> Result<bool, StepError> {
    let this = number(joint);
    let mut turned = [0.0; 2];
    for (index, turned) in turned.iter_mut().enumerate() {
        *turned = range(&rows.counts(index)) * TAU / bench.counts_per_turn(index)?;
    }
    // The greatest change of the current from its mean before the pulse, with its sign.
    let currents = [0, 1].map(|index: usize| {
        let codes = rows.current_codes(index);
        let zero = codes.iter().take(15).sum::<f64>() / 15.0;
        let duties = rows.duties(joint);
        let driven = codes
            .iter()
            .zip(&duties)
            .skip(20)
            .filter(|(_, duty)| **duty != 0.0);
        let changes: Vec<f64> = driven.map(|(code, _)| code - zero).collect();
        let early = changes.len().clamp(1, 30);
        let mean = changes.iter().take(early).sum::<f64>() / early as f64;
        mean * f64::from(bench.settings.axes[index].current_per_code)
    });
    let drive = bench.drive(joint)?;
    let applied = rows
        .duties(joint)
        .iter()
        .fold(0.0_f64, |most, duty| most.max(*duty));
    let expected = applied * bench.robot.supply.voltage / drive.resistance;
    let (own, other) = (currents[joint], currents[1 - joint]);
    let moved = turned.map(|turned| turned.abs() > MOVED);
    if own < -0.3 * expected {
        return Err(StepError::wrong(
            format_args!(
                "the current sense of joint {this} is reversed: a positive voltage reads {own:.2} A"
            ),
            "exchange the current sensor's ends, or the motor's current path through it",
        ));
    }
    if own.abs() < 0.3 * expected && other.abs() > 0.3 * expected {
        return Err(StepError::wrong(
            format_args!(
                "the current sensors are swapped: the bridge of joint {this} shows in the other one"
            ),
            "exchange the current sensors' wires to the board",
        ));
    }
    if own.abs() < 0.3 * expected {
        if moved[0] || moved[1] {
            return Err(StepError::wrong(
                format_args!(
                    "the current sensor of joint {this} is dead: its motor turns and it reads no current"
                ),
                "check the sensor's supply and its wire to the board",
            ));
        }
        if last {
            return Err(StepError::wrong(
                format_args!(
                    "the motor channel of joint {this} is dead: {:.1} V give no current",
                    applied * bench.robot.supply.voltage
                ),
                "check the motor's leads, the bridge's supply and its enable wire",
            ));
        }
        return Ok(false);
    }
    if moved[1 - joint] && turned[1 - joint].abs() > 2.0 * turned[joint].abs() {
        return Err(StepError::wrong(
            format_args!(
                "the motors are swapped: the bridge of joint {this} turns joint {}",
                number(1 - joint)
            ),
            "exchange the motors' plugs at the bridges",
        ));
    }
    if !moved[joint] {
        if last {
            return Err(StepError::wrong(
                format_args!("joint {this} does not move at its motor's continuous current"),
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
            format_args!(
                "the motor of joint {this} is reversed: a positive voltage turns it backwards"
            ),
            "exchange the motor's two leads",
        ));
    }
    Ok(true)
}

/// What a constant voltage or a sequence did to a motor, in units of the joint.
struct Motion {
    /// Between two rows [s].
    period: f64,
    angle: Vec<f64>,
    current: Vec<f64>,
    volts: Vec<f64>,
}

impl Motion {
    fn of(bench: &Bench, joint: usize, pulse: &Pulse, rows: &LogRows) -> Result<Self, StepError> {
        let axis = &bench.settings.axes[joint];
        let per_count = TAU / bench.counts_per_turn(joint)?;
        let codes = rows.current_codes(joint);
        let zero = bench.zeros[joint];
        let per_code = f64::from(axis.current_per_code);
        let bus = f64::from(bench.settings.protection.bus_voltage_per_code);
        Ok(Self {
            period: f64::from(pulse.every) / bench.robot.control.tick_rate,
            angle: rows
                .counts(joint)
                .iter()
                .map(|counts| counts * per_count)
                .collect(),
            current: codes.iter().map(|code| (code - zero) * per_code).collect(),
            volts: (rows.duties(joint).iter().zip(rows.bus_codes()))
                .map(|(duty, code)| duty * code * bus)
                .collect(),
        })
    }
}

const SIGNALS: [Signals; 2] = [
    Signals::COUNTS_1
        .union(Signals::CURRENT_1)
        .union(Signals::DUTY_1)
        .union(Signals::BUS_VOLTAGE),
    Signals::COUNTS_4
        .union(Signals::CURRENT_4)
        .union(Signals::DUTY_4)
        .union(Signals::BUS_VOLTAGE),
];

/// Resistance and inductance from a pseudo-random sequence of voltages, then the torque constant
/// by back-EMF.
pub(in super::super) fn electrics(bench: &mut Bench) -> Result<Outcome, StepError> {
    bench.measure_zeros()?;
    let (mut values, mut keys) = (Vec::new(), Vec::new());
    let mut found = Vec::new();
    for joint in [0, 1] {
        let [[r, r_sd], [l, l_sd]] = winding(bench, joint)?;
        let [k, k_sd] = torque_constant(bench, joint, r)?;
        let drive = bench.drive(joint)?;
        let this = number(joint);
        for (name, value, drawn) in [
            ("resistance", r, drive.resistance),
            ("inductance", l, drive.inductance),
            ("torque constant", k, drive.torque_constant),
        ] {
            if !(value > 0.3 * drawn && value < 3.0 * drawn) {
                return Err(StepError::wrong(
                    format_args!(
                        "the {name} of joint {this} is {value:.4e}, and the robot file has {drawn:.4e}"
                    ),
                    "check the motor's data sheet, current_per_code and voltage_per_code",
                ));
            }
        }
        found.push(format!(
            "joint {this}: {r:.3} Ω, {:.3} mH, {:.2} mN·m/A",
            1e3 * l,
            1e3 * k
        ));
        let prbs = "by a pseudo-random voltage";
        let emf = "by back-EMF at constant voltages";
        for (key, value, sd, origin) in [
            ("resistance", r, r_sd, prbs),
            ("inductance", l, l_sd, prbs),
            ("torque_constant", k, k_sd, emf),
        ] {
            values.push(Value::new(format!("{key}{this}"), value, origin).with_sd(sd));
            let key = MeasuredKey::Actuator(joint, key);
            keys.push(measured(
                key,
                format!("{value:.6e}"),
                format!("± {sd:.1e} {origin}"),
            ));
        }
    }
    Ok(Outcome {
        found: found.join("; "),
        values,
        measured: keys,
    })
}

/// R [Ω] and L [H], each with its deviation.
///
/// i⁺ = a i + (1−a)/R (u − Kω − v0), a = e^{−Rh/L}. The voltage of row k acts from row k+1 to k+2.
/// The mean speed is that of the counts; what the sequence itself adds to it follows the sum of the
/// currents.
fn winding(bench: &mut Bench, joint: usize) -> Result<[[f64; 2]; 2], StepError> {
    let drive = bench.drive(joint)?;
    let pulse = Pulse {
        joint,
        volts: [0.0, 0.85 * drive.continuous_current * drive.resistance],
        time: 0.28,
        travel: 0.3,
        signals: SIGNALS[joint],
        every: 1,
    };
    let (rows, _) = bench.excite(&pulse)?;
    let motion = Motion::of(bench, joint, &pulse, &rows)?;
    let omega = speeds(&motion, HALF);
    let impulse = ripple(&motion.current, HALF);
    let mut columns = Vec::new();
    let mut rights = Vec::new();
    for k in 20..motion.volts.len().saturating_sub(22) {
        if motion.volts[k] != 0.0 && motion.volts[k + 1] != 0.0 {
            columns.push(vec![
                motion.current[k + 1],
                motion.volts[k],
                omega[k + 1],
                impulse[k + 1],
                1.0,
            ]);
            rights.push(motion.current[k + 2]);
        }
    }
    let fit = least_squares(&columns, &rights)
        .ok_or_else(|| StepError::other("the sequence of voltages determines no resistance"))?;
    let ([a, b], [a_sd, b_sd]) = (
        [fit.values[0], fit.values[1]],
        [fit.deviations[0], fit.deviations[1]],
    );
    let r = (1.0 - a) / b;
    let l = -r * motion.period / a.ln();
    let r_sd = r * ((a_sd / (1.0 - a)).powi(2) + (b_sd / b).powi(2)).sqrt();
    let l_sd = l * ((r_sd / r).powi(2) + (a_sd / (a * a.ln())).powi(2)).sqrt();
    Ok([[r, r_sd], [l, l_sd]])
}

/// Rows to either side over which a speed is a mean.
const HALF: usize = 20;

/// The sum of the values up to each row, less its mean over `half` rows to either side.
fn ripple(values: &[f64], half: usize) -> Vec<f64> {
    let mut sum = 0.0;
    let sums: Vec<f64> = values
        .iter()
        .map(|value| {
            sum += value;
            sum - 0.5 * value
        })
        .collect();
    (0..sums.len())
        .map(|k| {
            let around = &sums[k.saturating_sub(half)..(k + half + 1).min(sums.len())];
            sums[k] - around.iter().sum::<f64>() / around.len() as f64
        })
        .collect()
}

/// Speeds [rad/s] by differences over `half` rows to either side.
fn speeds(motion: &Motion, half: usize) -> Vec<f64> {
    let last = motion.angle.len().saturating_sub(1);
    (0..motion.angle.len())
        .map(|k| {
            let (from, to) = (k.saturating_sub(half), (k + half).min(last));
            (motion.angle[to] - motion.angle[from]) / ((to - from).max(1) as f64 * motion.period)
        })
        .collect()
}

/// The torque constant [N·m/A] with its deviation, by constant voltages both ways:
/// u − R i = N K ω + v0 sign ω.
fn torque_constant(
    bench: &mut Bench,
    joint: usize,
    resistance: f64,
) -> Result<[f64; 2], StepError> {
    let drive = bench.drive(joint)?;
    let (mut rows, mut rights) = (Vec::new(), Vec::new());
    // Away from the switch first, and back over the same stretch.
    let away = if bench.settings.axes[joint].home_forward {
        -1.0
    } else {
        1.0
    };
    let away = away * drive.gear_ratio.signum();
    for share in [0.3, 0.45, 0.6, 0.75] {
        for sign in [away, -away] {
            let pulse = Pulse {
                joint,
                volts: [
                    sign * share * drive.continuous_current * drive.resistance,
                    0.0,
                ],
                time: 0.8,
                travel: 0.45,
                signals: SIGNALS[joint],
                every: 3,
            };
            let (log, _) = bench.excite(&pulse)?;
            let motion = Motion::of(bench, joint, &pulse, &log)?;
            let omega = speeds(&motion, 10);
            let last = omega.len().saturating_sub(20);
            for (k, &omega) in omega.iter().enumerate().take(last).skip(20) {
                let driven = motion.volts[k - 1] != 0.0 && motion.volts[k + 15] != 0.0;
                if driven && omega.abs() > 0.5 {
                    rows.push(vec![omega, omega.signum()]);
                    rights.push(motion.volts[k] - resistance * motion.current[k]);
                }
            }
        }
    }
    let fit = least_squares(&rows, &rights).ok_or_else(|| {
        StepError::wrong(
            format_args!("joint {} hardly turned at constant voltages", number(joint)),
            "check that it can turn by 0.5 rad away from its switch",
        )
    })?;
    let ratio = drive.gear_ratio;
    Ok([fit.values[0] / ratio, fit.deviations[0] / ratio.abs()])
}
