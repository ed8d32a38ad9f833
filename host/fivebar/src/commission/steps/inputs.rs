//! The steps that only read inputs: supply, emergency stop, home switches, encoders.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::operator::Task;
use super::super::record::Value;
use super::{Outcome, contactor};
use fivebar_files::robot::HomeMethod;
use fivebar_firmware::safety::Fault;
use fivebar_kinematics::five_bar::Joint;
use fivebar_sim::machine::Signal;
use std::f64::consts::{FRAC_PI_4, TAU};

/// Greatest difference of the bus voltage from the robot file's, as a share.
const VOLTAGE_TOLERANCE: f64 = 0.08;
/// Greatest difference of a current sensor's zero from the middle [codes].
const ZERO_TOLERANCE: f64 = 100.0;
/// The angle by which joints are turned by hand [rad], and the tolerance of that, as a share.
const TURN: f64 = FRAC_PI_4;
pub(super) const TURN_TOLERANCE: f64 = 0.1;
/// Turn below which a joint has stayed where it was [rad].
const STILL: f64 = 0.05;

fn mean(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let variance = values.map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    [mean, variance.sqrt()]
}

/// The bus voltage, and the current sensors with the bridges off.
pub(in super::super) fn supply(bench: &mut Bench) -> Result<Outcome, StepError> {
    let samples = bench.samples(0.5)?;
    let per_code = f64::from(bench.settings.protection.bus_voltage_per_code);
    let [volts, noise] = mean(samples.iter().map(|s| f64::from(s.drives.both) * per_code));
    let wanted = bench.robot.supply.voltage;
    if (volts - wanted).abs() > VOLTAGE_TOLERANCE * wanted {
        return Err(StepError::wrong(
            format_args!(
                "the supply is wrong: the bus has {volts:.1} V, the robot file {wanted:.1} V"
            ),
            "set the supply to the robot file's voltage; if a meter at the board shows that, correct \
             [supply] voltage_per_code",
        ));
    }
    let mut values = vec![
        Value::new("bus_voltage_v", volts, "mean of 0.5 s with the bridges off").with_sd(noise),
    ];
    for joint in Joint::ALL {
        let codes = samples
            .iter()
            .map(|sample| f64::from(sample.drives.joints[joint]));
        let [zero, noise] = mean(codes);
        let middle = f64::from(bench.settings.axes[joint].current_zero_code);
        if (zero - middle).abs() > ZERO_TOLERANCE {
            return Err(StepError::wrong(
                format_args!(
                    "the current sensor of {joint} reads code {zero:.0} with the bridges \
                     off, and {middle:.0} is no current"
                ),
                "check the sensor's supply and reference, and its wire to the board",
            ));
        }
        let name = format!("current_zero{}_codes", joint.number());
        values.push(Value::new(name, zero, "with the bridges off").with_sd(noise));
    }
    let found = format!("the bus has {volts:.2} V, and both current sensors read no current");
    Ok(Outcome::new(found, values))
}

/// The emergency stop latches its fault, which stays until released and cleared, and takes the bus
/// voltage away.
pub(in super::super) fn emergency_stop(bench: &mut Bench) -> Result<Outcome, StepError> {
    let stuck = || {
        StepError::wrong(
            "the emergency stop reads as pressed although it is released",
            "check that S1a is closed when released, and its wire: a broken wire reads as pressed",
        )
    };
    if bench.sample()?.emergency_stop {
        return Err(stuck());
    }
    // A board that measures no bus voltage does not see the contactor.
    let volts = match bench.shows(Signal::BusVoltage) {
        true => Some(contactor::bus(bench)?),
        false => None,
    };
    bench.ask(Task::PressStop)?;
    let status = bench.pause(0.1)?;
    if status.fault != Some(Fault::EmergencyStop) {
        bench.ask(Task::ReleaseStop)?;
        return Err(StepError::wrong(
            "the emergency stop was pressed and the controller does not see it",
            "check S1a and its wire to the board; do not go on before it works",
        ));
    }
    let fell = volts.map(|volts| contactor::opens(bench, volts));
    if fell.is_none() {
        bench
            .report("the board does not measure the motors' supply: measure that it falls, too")?;
    }
    bench.ask(Task::ReleaseStop)?;
    let fell = fell.transpose()?;
    if bench.sample()?.emergency_stop {
        return Err(stuck());
    }
    if let Some(volts) = volts {
        contactor::closes(bench, volts)?;
    }
    let status = bench.pause(0.1)?;
    if status.fault != Some(Fault::EmergencyStop) {
        return Err(StepError::other(
            "the fault of the emergency stop did not stay latched",
        ));
    }
    bench.clear()?;
    let latches = "it latches fault 10 until it is released and cleared";
    Ok(match fell {
        Some(fell) => Outcome::new(
            format!("{latches}, and opens the contactor"),
            vec![Value::new(
                "contactor_bus_fall_s",
                fell,
                "until the bus has 80 % of its voltage, the emergency stop pressed",
            )],
        ),
        None => Outcome::new(latches, vec![]),
    })
}

/// Each home switch reads open, then pressed when it is pressed.
pub(in super::super) fn switches(bench: &mut Bench) -> Result<Outcome, StepError> {
    let stuck = |joint: Joint| {
        StepError::wrong(
            format_args!(
                "the home switch of {joint} is stuck: it reads as pressed and nobody presses it"
            ),
            "turn the joint away from its switch; then check the switch and its wire, because a \
             broken wire reads as pressed",
        )
    };
    let searched = [HomeMethod::Switch, HomeMethod::Index];
    if !searched.contains(&bench.robot.homing.method) {
        return Ok(Outcome::new("the arm is homed without switches", vec![]));
    }
    let home = bench.sample()?.home;
    if let Some(joint) = Joint::ALL.into_iter().find(|&joint| home[joint]) {
        return Err(stuck(joint));
    }
    for joint in Joint::ALL {
        bench.ask(Task::PressSwitch(joint))?;
        let home = bench.sample()?.home;
        bench.ask(Task::ReleaseSwitches)?;
        if !home[joint] {
            let other = joint.other();
            let (wrong, change) = if home[other] {
                (
                    format!("the home switches are swapped: that of {other} reads as pressed"),
                    "exchange the switches' wires at the board",
                )
            } else {
                (
                    format!("the home switch of {joint} is stuck open"),
                    "check the switch: its contact must open when it is pressed",
                )
            };
            return Err(StepError::wrong(wrong, change));
        }
        let after = bench.sample()?.home;
        if let Some(joint) = Joint::ALL.into_iter().find(|&joint| after[joint]) {
            return Err(stuck(joint));
        }
    }
    Ok(Outcome::new(
        "both are open when released and read as pressed when pressed",
        vec![],
    ))
}

/// Each joint's encoder counts in its direction, as many counts as the robot file says.
pub(in super::super) fn encoders(bench: &mut Bench) -> Result<Outcome, StepError> {
    let mut values = Vec::new();
    for joint in Joint::ALL {
        let (away, turned) = turned_by_hand(bench, joint)?;
        judge_turn(bench, joint, away, turned)?;
        let name = format!("counts{}_share", joint.number());
        let origin = "counts over 45° by hand, over those of the robot file";
        values.push(Value::new(name, turned[joint] / away, origin));
    }
    bench.ask(Task::LetGo)?;
    Ok(Outcome::new(
        "both count in their direction, as many counts as the robot file says",
        values,
    ))
}

/// Asks for a turn of a joint by hand, away from its switch, and back; the turn, and what both encoders tell of it [rad].
pub(super) fn turned_by_hand(
    bench: &mut Bench,
    joint: Joint,
) -> Result<(f64, [f64; 2]), StepError> {
    let away = match bench.settings.axes[joint].home_forward {
        true => -TURN,
        false => TURN,
    };
    let before = bench.sample()?.counts;
    bench.ask(Task::Turn(joint, away))?;
    let after = bench.sample()?.counts;
    bench.ask(Task::Turn(joint, -away))?;
    let mut turned = [0.0; 2];
    for (joint, turned) in Joint::ALL.into_iter().zip(&mut turned) {
        let counts = f64::from(after[joint].wrapping_sub(before[joint]));
        *turned = counts * TAU / bench.counts_per_turn(joint)?;
    }
    Ok((away, turned))
}

fn judge_turn(bench: &Bench, joint: Joint, by: f64, turned: [f64; 2]) -> Result<(), StepError> {
    let other_joint = joint.other();
    let (own, other) = (turned[joint], turned[other_joint]);
    if own.abs() < STILL && other.abs() > STILL {
        return Err(StepError::wrong(
            format_args!(
                "the encoders are swapped: {joint} was turned and that of {other_joint} counts"
            ),
            "exchange the encoders' plugs",
        ));
    }
    if own.abs() < STILL {
        return Err(StepError::wrong(
            format_args!(
                "the encoder of {joint} is dead: the joint was turned and it does not count"
            ),
            "check its supply, both channels and its plug",
        ));
    }
    if own * by < 0.0 {
        return Err(StepError::wrong(
            format_args!("the encoder of {joint} is reversed: it counts backwards"),
            "exchange its channels A and B; if motor and joint turn against each other, give a \
             negative gear_ratio",
        ));
    }
    let share = own / by;
    if (share - 1.0).abs() > TURN_TOLERANCE {
        let counts = share * bench.counts_per_turn(joint)?.abs();
        return Err(StepError::wrong(
            format_args!(
                "the counts or the gear ratio of {joint} are wrong: it has {share:.2} times the \
                 counts of the robot file, about {counts:.0} per turn of the joint"
            ),
            "correct encoder_counts (after quadrature: four times the lines) or gear_ratio",
        ));
    }
    if other.abs() > 0.5 * TURN {
        return Err(StepError::wrong(
            format_args!("both encoders count when {joint} is turned"),
            "hold the other joint; if it did not move, check the encoders' wires for a bridge",
        ));
    }
    Ok(())
}
