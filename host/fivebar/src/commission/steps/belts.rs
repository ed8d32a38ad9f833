//! The step that finds the stiffness and the damping of belts from the answer of their motors to a pseudo-random voltage.

use super::super::bench::{Bench, Pulse};
use super::super::finding::StepError;
use super::super::record::Value;
use super::electrics::away_from_switch;
use super::moving::{angles, currents};
use super::{Outcome, measured};
use fivebar_design::identification::{BeltArm, BeltLog, FoundBelt, identify_belt};
use fivebar_files::robot::{Actuator, MeasuredKey};
use fivebar_firmware::recorder::Signals;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::EncoderSide;
use nalgebra::Matrix2;

/// The speed at which a joint turns meanwhile, so that its friction does not change [rad/s], for this time [s], and the
/// travel at which it ends [rad].
const SPEED: f64 = 1.5;
const TIME: f64 = 0.28;
const TRAVEL: f64 = 0.45;
/// The amplitude of the voltage, per that of the continuous current.
const AMPLITUDE: f64 = 0.7;
/// A belt with less of the file's stiffness is loose or worn.
const LOOSE: f64 = 0.5;
/// One with so many times the file's is not the file's belt.
const STIFF: f64 = 2.0;

/// Stiffness and damping of both belts.
pub(in super::super) fn belts(bench: &mut Bench) -> Result<Outcome, StepError> {
    let drives = [bench.drive(Joint::Joint1)?, bench.drive(Joint::Joint4)?];
    let [Some(stiffness1), Some(stiffness4)] = drives.map(|drive| drive.stiffness) else {
        let why = "left out: the robot file states no `stiffness` of both drives";
        return Ok(Outcome::left_out(why));
    };
    let (mut values, mut keys, mut texts) = (Vec::new(), Vec::new(), Vec::new());
    for (joint, known) in Joint::ALL.into_iter().zip([stiffness1, stiffness4]) {
        let found = belt(bench, joint, &drives)?;
        let ([k, k_sd], [d, d_sd]) = (found.stiffness, found.damping);
        judge(joint, k, known, found.mode)?;
        texts.push(format!(
            "{joint}: {k:.0} N·m/rad and {:.2} mN·m·s/rad, a mode of {:.0} Hz",
            1e3 * d,
            found.mode
        ));
        let this = joint.number();
        let origin = "by a pseudo-random voltage; the deviation is of noise alone";
        let mode = Value::new(format!("belt_mode{this}_hz"), found.mode, origin);
        values.push(mode);
        for (key, unit, value, sd) in [
            ("stiffness", "nm_per_rad", k, k_sd),
            ("drive_damping", "nms", d, d_sd),
        ] {
            values.push(Value::new(format!("{key}{this}_{unit}"), value, origin).with_sd(sd));
            keys.push(measured(
                MeasuredKey::Actuator(joint, key),
                format!("{value:.6e}"),
                format!("± {sd:.1e} {origin}"),
            ));
        }
    }
    Ok(Outcome {
        measured: keys,
        ..Outcome::new(texts.join("; "), values)
    })
}

/// Names a belt that is far from the file's.
fn judge(joint: Joint, found: f64, known: f64, mode: f64) -> Result<(), StepError> {
    let share = found / known;
    if (LOOSE..=STIFF).contains(&share) {
        return Ok(());
    }
    let what = format!(
        "the belt of {joint} has {found:.0} N·m/rad, {share:.2} of the robot file's {known:.0}, by its mode of \
         {mode:.0} Hz"
    );
    Err(if share < LOOSE {
        StepError::wrong(
            format_args!("{what}: it is loose or worn"),
            "tighten or change it; if it is as it should be, state its `stiffness` in the robot file",
        )
    } else {
        StepError::wrong(
            what,
            "check `stiffness`, `rotor_inertia` and `gear_ratio` of the robot file",
        )
    })
}

/// One belt. The arm is homed first, so that its pose is known, then forgets its angles, as excitations want it.
fn belt(bench: &mut Bench, joint: Joint, drives: &[Actuator; 2]) -> Result<FoundBelt, StepError> {
    bench.home()?;
    let status = bench.pause(0.1)?;
    let [theta1, theta4] = status.angle.map(f64::from);
    bench.upload()?;
    bench.measure_zeros()?;
    let drive = &drives[joint];
    let per_speed = drive.gear_ratio.abs() * drive.torque_constant;
    let turning = drive.resistance * drive.coulomb_friction / per_speed + per_speed * SPEED;
    let pulse = Pulse {
        joint,
        volts: [
            away_from_switch(bench, joint)? * turning,
            AMPLITUDE * drive.continuous_current * drive.resistance,
        ],
        time: TIME,
        travel: TRAVEL,
        current: drive.continuous_current,
        signals: [
            Signals::COUNTS_1 | Signals::SENSED_1,
            Signals::COUNTS_4 | Signals::SENSED_4,
        ][joint],
        every: 1,
    };
    let (rows, _) = bench.excite(&pulse)?;
    let angle = angles(bench, joint, 0.0, &rows)?;
    let torque: Vec<f64> = currents(bench, joint, &rows)?
        .iter()
        .map(|current| per_speed * current)
        .collect();
    let middle = 0.5 * (angle.first().unwrap_or(&0.0) + angle.last().unwrap_or(&0.0));
    let mut theta = [theta1, theta4];
    theta[joint] += middle;
    let log = BeltLog {
        joint,
        period: 1.0 / bench.robot.control.tick_rate,
        angle: &angle,
        torque: &torque,
        time_constant: drive.inductance / drive.resistance,
        latency: drive.encoder_latency,
    };
    identify_belt(&arm_at(bench, theta, drives)?, &log).ok_or_else(|| {
        StepError::wrong(
            format_args!(
                "the belt of {joint} does not show in its motor's answer to {:.1} V",
                pulse.volts[1]
            ),
            "check that the joint turns freely away from its switch, and the robot file's `stiffness`, \
             `rotor_inertia` and `encoder_latency`",
        )
    })
}

/// What is known of the arm with its joints at these angles.
fn arm_at(bench: &Bench, theta: [f64; 2], drives: &[Actuator; 2]) -> Result<BeltArm, StepError> {
    let robot = &bench.robot;
    let home = robot.home_pose().map_err(StepError::other)?;
    let pose = robot
        .geometry
        .forward(theta[0], theta[1], home.assembly())
        .map_err(StepError::other)?;
    let arm = robot.arm().map_err(StepError::other)?;
    let rotors = arm.rotor_inertia();
    let whole = arm.mass_matrix(&pose).map_err(StepError::other)?;
    let each = |of: fn(&Actuator) -> f64| [of(&drives[0]), of(&drives[1])];
    Ok(BeltArm {
        links: whole - Matrix2::from_diagonal(&rotors.into()),
        rotors,
        friction: each(|drive| drive.viscous_friction),
        stiffness: each(|drive| drive.stiffness.unwrap_or_default()),
        damping: each(|drive| drive.drive_damping),
        shorted: each(|drive| {
            (drive.gear_ratio * drive.torque_constant).powi(2) / drive.resistance
        }),
        encoder_at_joint: [0, 1].map(|j| drives[j].encoder_side == EncoderSide::Joint),
    })
}
