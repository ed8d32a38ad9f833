//! The step that puts voltages on one motor at a time and finds its resistance, inductance and torque
//! constant.

use super::super::bench::{Bench, Pulse};
use super::super::finding::StepError;
use super::super::log::LogRows;
use super::super::record::Value;
use super::bridge_limit::bridge_limit;
use super::fit::least_squares;
use super::{Outcome, measured};
use fivebar_files::robot::MeasuredKey;
use fivebar_firmware::recorder::Signals;
use fivebar_kinematics::five_bar::Joint;
use std::f64::consts::TAU;

/// Steps of the bridges' timer from no voltage to that of the bus.
const PWM_STEPS: f64 = 4200.0;

/// The voltage nearest to `volts` that the bridges apply exactly: a voltage between two steps of their
/// timer is off by up to 0.3 % of a small one.
fn applied_exactly(bench: &Bench, volts: f64) -> f64 {
    let step = bench.robot.supply.voltage / PWM_STEPS;
    (volts / step).round() * step
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
    fn of(bench: &Bench, joint: Joint, pulse: &Pulse, rows: &LogRows) -> Result<Self, StepError> {
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

/// Rows for each unknown of a fit [1]: with fewer, noise alone could look like a motor.
const LEAST_ROWS: usize = 5;

const SIGNALS: [Signals; 2] = [
    Signals::COUNTS_1
        .union(Signals::SENSED_1)
        .union(Signals::TOLD_1)
        .union(Signals::SENSED_OF_BOTH),
    Signals::COUNTS_4
        .union(Signals::SENSED_4)
        .union(Signals::TOLD_4)
        .union(Signals::SENSED_OF_BOTH),
];

/// Resistance and inductance from a pseudo-random sequence of voltages, then the torque constant
/// by back-EMF.
pub(in super::super) fn electrics(bench: &mut Bench) -> Result<Outcome, StepError> {
    bench.measure_zeros()?;
    let (mut values, mut keys) = (Vec::new(), Vec::new());
    let mut found = Vec::new();
    for joint in Joint::ALL {
        let [[r, r_sd], [l, l_sd]] = winding(bench, joint)?;
        let (limit, pulse_current) = bridge_limit(bench, joint, r)?;
        values.push(pulse_current);
        let [k, k_sd] = torque_constant(bench, joint, [r, l])?;
        let drive = bench.drive(joint)?;
        let this = joint.number();
        for (name, value, drawn) in [
            ("resistance", r, drive.resistance),
            ("inductance", l, drive.inductance),
            ("torque constant", k, drive.torque_constant),
        ] {
            if !(value > 0.3 * drawn && value < 3.0 * drawn) {
                return Err(StepError::wrong(
                    format_args!(
                        "the {name} of {joint} is {value:.4e}, and the robot file has {drawn:.4e}"
                    ),
                    "check the motor's data sheet, current_per_code and voltage_per_code",
                ));
            }
        }
        found.push(format!(
            "{joint}: {r:.3} Ω, {:.3} mH, {:.2} mN·m/A, {limit}",
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
        for (name, value) in ["travel1_rad", "current1_a"]
            .into_iter()
            .zip(bench.greatest[joint])
        {
            let name = format!("greatest_{}", name.replace('1', &this.to_string()));
            values.push(Value::new(name, value, "in all excitations"));
        }
    }
    Ok(Outcome {
        measured: keys,
        ..Outcome::new(found.join("; "), values)
    })
}

/// R [Ω] and L [H], each with its deviation.
///
/// i⁺ = a i + (1−a)/R (u − Kω − v0), a = e^{−Rh/L}. The voltage of row k acts from row k+1 to k+2.
/// The mean speed is that of the counts; what the sequence itself adds to it follows the sum of the
/// currents.
fn winding(bench: &mut Bench, joint: Joint) -> Result<[[f64; 2]; 2], StepError> {
    let drive = bench.drive(joint)?;
    let holding = drive.continuous_current * drive.resistance;
    let pulse = Pulse {
        joint,
        volts: [0.0, applied_exactly(bench, 0.85 * holding)],
        time: 0.28,
        travel: 0.3,
        current: drive.continuous_current,
        signals: SIGNALS[joint],
        every: 1,
    };
    let (rows, _) = bench.excite(&pulse)?;
    let motion = Motion::of(bench, joint, &pulse, &rows)?;
    let omega = rates(&motion.angle, motion.period, HALF);
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
    let fit = least_squares(&columns, &rights, LEAST_ROWS)
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

/// Rates [1/s] by differences over `half` rows of `period` [s] to either side.
fn rates(values: &[f64], period: f64, half: usize) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    (0..values.len())
        .map(|k| {
            let (from, to) = (k.saturating_sub(half), (k + half).min(last));
            (values[to] - values[from]) / ((to - from).max(1) as f64 * period)
        })
        .collect()
}

/// The sign of a voltage that turns a joint away from its switch.
pub(super) fn away_from_switch(bench: &Bench, joint: Joint) -> Result<f64, StepError> {
    let away = if bench.settings.axes[joint].home_forward {
        -1.0
    } else {
        1.0
    };
    Ok(away * bench.drive(joint)?.gear_ratio.signum())
}

/// The torque constant [N·m/A] with its deviation, by constant voltages in both directions:
/// u − R i − L di/dt = N K ω + v0 sign ω. The current falls while the joint gains speed: without its
/// rate K comes out 0.3 % too great on the benchtop arm.
fn torque_constant(
    bench: &mut Bench,
    joint: Joint,
    [resistance, inductance]: [f64; 2],
) -> Result<[f64; 2], StepError> {
    let drive = bench.drive(joint)?;
    let (mut rows, mut rights) = (Vec::new(), Vec::new());
    // Away from the switch first, and back over the same stretch.
    let away = away_from_switch(bench, joint)?;
    let holding = drive.continuous_current * drive.resistance;
    for share in [0.3, 0.45, 0.6, 0.75] {
        for sign in [away, -away] {
            let pulse = Pulse {
                joint,
                volts: [applied_exactly(bench, sign * share * holding), 0.0],
                time: 0.8,
                travel: 0.45,
                current: drive.continuous_current,
                signals: SIGNALS[joint],
                every: 3,
            };
            let (log, _) = bench.excite(&pulse)?;
            let motion = Motion::of(bench, joint, &pulse, &log)?;
            let omega = rates(&motion.angle, motion.period, 10);
            let current_rate = rates(&motion.current, motion.period, 10);
            let last = omega.len().saturating_sub(20);
            for (k, &omega) in omega.iter().enumerate().take(last).skip(20) {
                let driven = motion.volts[k - 1] != 0.0 && motion.volts[k + 15] != 0.0;
                if driven && omega.abs() > 0.5 {
                    rows.push(vec![omega, omega.signum()]);
                    let in_winding = resistance * motion.current[k] + inductance * current_rate[k];
                    rights.push(motion.volts[k] - in_winding);
                }
            }
        }
    }
    let fit = least_squares(&rows, &rights, LEAST_ROWS).ok_or_else(|| {
        StepError::wrong(
            format_args!("{joint} hardly turned at constant voltages"),
            "check that it can turn by 0.5 rad away from its switch",
        )
    })?;
    let ratio = drive.gear_ratio;
    Ok([fit.values[0] / ratio, fit.deviations[0] / ratio.abs()])
}
