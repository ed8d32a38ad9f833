//! Torque drives on a CAN bus: what is known of them, and their checks.

use super::Robot;
use super::actuator::{Actuator, CanTorque};
use super::home_method::HomeMethod;
use super::sections::ControlFile;
use super::value::positive;
use crate::refusal::{Key, Refusal, Refusals};
use fivebar_firmware::drives::can::{
    BIT_RATE, BusSetup, MOST_LOAD, Protocol, mit, most_load, odrive, sensed_after, watchdog,
};
use fivebar_firmware::drives::{DriveStiffness, OLDEST_ANSWER, OLDEST_SAMPLE, TorqueDrives};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::CanDrive;
use std::f64::consts::TAU;

/// Turns of a drive's loops in a second [Hz]: ODrive's; MIT-type drives have more.
const LOOP_RATE: f64 = 8000.0;
/// Bandwidths of current loops, and of the loop that tracks the encoder [rad/s]. With both its poles at ω, a tracking loop
/// that turns once in P is unstable from ωP = 0.83 on, and rings from 0.5 on, where the product of its poles, 1 − 2 ωP, is
/// negative.
const BANDWIDTHS: [f64; 2] = [200.0, 0.5 * LOOP_RATE];
/// Steps of the frames that spring and damper of an MIT-type drive need: a fraction that is cut off then takes a quarter.
const LEAST_STEPS: f64 = 4.0;

impl CanTorque {
    /// Without one in the file, a torque of 1 N·m is told as a current of 1 A [N·m/A].
    pub(super) const TORQUE_CONSTANT: f64 = 1.0;
    /// That of ODrive as delivered, `current_control_bandwidth` [rad/s].
    pub(super) const CURRENT_BANDWIDTH: f64 = 1000.0;
    /// No winding is seen through a drive; its resistance only gives the lag of the loop its inductance [Ω].
    pub(super) const RESISTANCE: f64 = 1e-3;
    /// Drives guard their own motors: no model of heat does [s].
    pub(super) const HEATING: f64 = 600.0;
    /// Ticks in a second that the bus has room for [Hz].
    pub(super) const TICK_RATE: f64 = 1000.0;

    /// Counts per turn of the shaft: of the 14 bits of ODrive's own encoder, or those that the protocol tells.
    pub(super) fn counts(protocol: &Protocol) -> u32 {
        match protocol {
            Protocol::Odrive => 16_384,
            Protocol::Mit(ranges) => {
                (65_535.0 * TAU / (2.0 * f64::from(ranges.position))).round() as u32
            }
        }
    }

    /// The greatest node.
    fn most_node(&self) -> u8 {
        match self.protocol {
            Protocol::Odrive => odrive::MOST_NODE,
            Protocol::Mit(_) => mit::MOST_NODE,
        }
    }
}

impl Robot {
    /// Its drives on a bus; none if its joints are turned by others.
    pub fn can_drives(&self) -> Option<[CanTorque; 2]> {
        let [first, second] = self.actuators.as_ref()?;
        Some([*first.can()?, *second.can()?])
    }

    /// Which drives are on its bus.
    pub(super) fn bus_setup(&self) -> Option<BusSetup> {
        let [first, second] = self.can_drives()?;
        Some(BusSetup {
            protocol: first.protocol,
            nodes: [first.node, second.node],
        })
    }

    /// What its drives speak, and the drives of the simulated arm.
    pub fn can_bus(&self) -> Option<(Protocol, [CanDrive; 2])> {
        let (drives, actuators) = (self.can_drives()?, self.actuators?);
        let drive = |j: Joint| CanDrive {
            node: drives[j].node,
            gear_ratio: actuators[j].gear_ratio,
            rotor_inertia: actuators[j].rotor_inertia,
            peak_torque: drives[j].peak_torque,
            lag: 1.0 / drives[j].current_bandwidth,
            watchdog: f64::from(watchdog(self.control.tick_rate as f32)),
        };
        Some((drives[0].protocol, Joint::ALL.map(drive)))
    }
}

/// The age of each drive's answer when a tick takes it [s].
fn ages(drives: &[Actuator; 2], tick_rate: f64) -> Option<[f64; 2]> {
    let [first, second] = [drives[0].can()?, drives[1].can()?];
    let sensed = sensed_after(&first.protocol, [first.node, second.node]);
    Some(sensed.map(|after| (1.0 / tick_rate - f64::from(after)).max(0.0)))
}

/// Notes the age of the answers of drives on a bus, as the latency of the encoders, and gives the loops what the bus
/// allows.
pub(super) fn with_latency(
    actuators: Option<[Actuator; 2]>,
    control: &mut ControlFile,
) -> Option<[Actuator; 2]> {
    let mut actuators = actuators?;
    let tick_rate = control.tick_rate.unwrap_or(CanTorque::TICK_RATE);
    let Some(ages) = ages(&actuators, tick_rate) else {
        return Some(actuators);
    };
    for (actuator, age) in actuators.iter_mut().zip(ages) {
        actuator.encoder_latency = age;
    }
    control.tick_rate = Some(tick_rate);
    control.complete_by_lag(lag(&actuators, tick_rate), tick_rate);
    Some(actuators)
}

/// The longer time from the moment that a drive senses its motor until the torque of it acts [s].
fn lag(actuators: &[Actuator; 2], tick_rate: f64) -> f64 {
    let of = |actuator: &Actuator| {
        let of_loop = actuator.inductance / actuator.resistance;
        let lag = TorqueDrives::lag_of(tick_rate as f32, of_loop as f32);
        actuator.encoder_latency + f64::from(lag)
    };
    of(&actuators[0]).max(of(&actuators[1]))
}

/// Checks each drive by itself.
pub(super) fn check_can_drive(index: usize, actuator: &Actuator, refusals: &mut Refusals) {
    let Some(drive) = actuator.can() else {
        return;
    };
    let key = |name| Key::Of("actuator", index, name);
    if drive.node > drive.most_node() {
        let most = drive.most_node();
        let reason = format!("must be 0 to {most} in this protocol, not {}", drive.node);
        refusals.add(key("node"), reason);
    }
    for (name, value) in [
        ("peak_torque", drive.peak_torque),
        ("continuous_torque", drive.continuous_torque),
        ("max_speed", drive.max_speed),
        ("current_bandwidth", drive.current_bandwidth),
    ] {
        refusals.note(positive(key(name), value));
    }
    let [least, greatest] = BANDWIDTHS;
    if !(least..=greatest).contains(&drive.current_bandwidth) {
        let reason = format!(
            "of the drive's current loop, and of the loop that tracks its encoder {LOOP_RATE:.0} times a second, must be \
             {least:.0} to {greatest:.0} rad/s, not {:?} rad/s: above that the tracking loop rings; give the drive and \
             the file a lower one",
            drive.current_bandwidth
        );
        refusals.add(key("current_bandwidth"), reason);
    }
    if drive.continuous_torque > drive.peak_torque {
        let reason = format!(
            "must be at most `peak_torque`, {:?} N·m, not {:?} N·m",
            drive.peak_torque, drive.continuous_torque
        );
        refusals.add(key("continuous_torque"), reason);
    }
    if let Protocol::Mit(ranges) = drive.protocol {
        for (name, range, needed, of, unit) in [
            (
                "torque_range",
                ranges.torque,
                drive.peak_torque,
                "peak_torque",
                "N·m",
            ),
            (
                "velocity_range",
                ranges.velocity,
                drive.max_speed,
                "max_speed",
                "rad/s",
            ),
        ] {
            refusals.note(positive(key(name), range.into()));
            if f64::from(range) < needed {
                let reason = format!(
                    "must be at least `{of}`, {needed:?} {unit}, not {range:?} {unit}: the frames hold no more"
                );
                refusals.add(key(name), reason);
            }
        }
        refusals.note(positive(key("position_range"), ranges.position.into()));
    }
}

/// Checks the drives of a robot with each other, its bus, its speeds and its weight.
pub(super) fn can_drives_fit(robot: &Robot, weights: [f64; 2], refusals: &mut Refusals) {
    let (Some(actuators), Some([first, second])) = (&robot.actuators, robot.can_drives()) else {
        return;
    };
    let of_second = |name| Key::Of("actuator", 1, name);
    if first.protocol != second.protocol {
        let reason =
            "must be the same for both drives, with the same ranges: they share a bus and a tick";
        refusals.add(of_second("protocol"), reason);
    }
    if first.node == second.node {
        let reason = format!(
            "is {}, as that of the other drive: both would answer each command; give one of them another number",
            second.node
        );
        refusals.add(of_second("node"), reason);
    }
    bus(robot, &first.protocol, refusals);
    if robot.homing.method == HomeMethod::Index {
        let reason = "is \"index\", and the drives tell no index pulse: use \"absolute\", \"switch\" or \"given\"";
        refusals.add(Key::In("homing", "method"), reason);
    }
    if robot.crossing.allowed {
        let reason = "is for brushed motors: with drives on a CAN bus leave it out";
        refusals.add(Key::In("crossing", "allowed"), reason);
    }
    for joint in Joint::ALL {
        let (actuator, drive) = (&actuators[joint], [first, second][joint.index()]);
        let key = |name| Key::Of("actuator", joint.index(), name);
        let gear = actuator.gear_ratio.abs();
        let weight = weights[joint.index()];
        for (name, torque) in [
            ("peak_torque", drive.peak_torque),
            ("continuous_torque", drive.continuous_torque),
        ] {
            if weight > torque * gear {
                let reason = format!(
                    "cannot hold {joint} against gravity: in some pose it needs {weight:.3} N·m at the joint, and the drive \
                     gives {:.3} N·m there: take a stronger one, or a greater `gear_ratio`",
                    torque * gear
                );
                refusals.add(key(name), reason);
                break;
            }
        }
        let speed = robot.limits.max_speed[joint];
        if speed * gear > drive.max_speed {
            let reason = format!(
                "of {joint} needs {:.1} rad/s of the drive, and its `max_speed` is {:?} rad/s: lower it to {:.3} rad/s",
                speed * gear,
                drive.max_speed,
                drive.max_speed / gear
            );
            refusals.add(Key::In("limits", "max_speed"), reason);
        }
        let most = TAU * f64::from(odrive::MOST_INPUT);
        if drive.protocol == Protocol::Odrive && speed * gear > most {
            let reason = format!(
                "of {joint} needs {:.1} rad/s of the drive, and its frames hold {most:.0} rad/s: lower it to {:.3} rad/s",
                speed * gear,
                most / gear
            );
            refusals.add(Key::In("limits", "max_speed"), reason);
        }
        refusals.note(positions(robot, joint, &drive, gear));
    }
    if let Protocol::Mit(_) = first.protocol {
        gains(robot, refusals);
    }
}

/// Whether the frames of MIT-type drives hold the springs and dampers that follow from the bandwidths of their loops.
fn gains(robot: &Robot, refusals: &mut Refusals) {
    let Some(settings) = robot.settings().ok().and_then(|it| it.check().ok()) else {
        return;
    };
    let springs = DriveStiffness::of(&settings);
    for joint in Joint::ALL {
        let (spring, ratio) = (
            springs[joint.index()],
            settings.axes[joint.index()].gear_ratio,
        );
        let square = f64::from(ratio * ratio);
        for (name, value, most, unit) in [
            ("stiffness", spring.stiffness, mit::STIFFNESS, "N·m/rad"),
            ("damping", spring.damping, mit::DAMPING, "N·m·s/rad"),
        ] {
            let (value, most) = (f64::from(value) / square, f64::from(most));
            let least = LEAST_STEPS * most / 4095.0;
            if !(least..=most).contains(&value) {
                let remedy = if value < least { "a higher" } else { "a lower" };
                let reason = format!(
                    "of {joint} makes a {name} of {value:.2e} {unit} at the drive, and its frames hold {least:.2e} to \
                     {most:?} {unit} with a sense: {remedy} one, or another `gear_ratio`, is needed"
                );
                let key = Key::Of("actuator", joint.index(), "current_bandwidth");
                refusals.add(key, reason);
                break;
            }
        }
    }
}

/// Whether the frames hold the positions of a joint, whose drive turns so many times as fast.
fn positions(robot: &Robot, joint: Joint, drive: &CanTorque, gear: f64) -> Result<(), Refusal> {
    if let Protocol::Mit(ranges) = drive.protocol {
        let range = f64::from(ranges.position);
        let home = robot.home[joint];
        let ends = robot.limits.angle[joint].map(|angle| (angle - home).abs() * gear);
        let most = ends[0].max(ends[1]);
        if most > range {
            let reason = format!(
                "of {range:?} rad ends before {joint} does: its `angle` of [limits] is up to {most:.2} rad of the \
                 drive from home"
            );
            let key = Key::Of("actuator", joint.index(), "position_range");
            return Err(key.refused(reason));
        }
    }
    Ok(())
}

/// Whether the bus has room for every tick, and answers are young enough.
fn bus(robot: &Robot, protocol: &Protocol, refusals: &mut Refusals) {
    let tick_rate = robot.control.tick_rate;
    let load = f64::from(most_load(protocol, tick_rate as f32));
    let most = f64::from(MOST_LOAD);
    let key = Key::In("control", "tick_rate");
    if load > most {
        let reason = format!(
            "is {tick_rate:?} Hz, at which the frames of both drives take up to {:.0} % of a bus of {} Mbit/s: at most \
             {:.0} % leave room for frames that are sent again; {:.0} Hz do",
            100.0 * load,
            BIT_RATE / 1e6,
            100.0 * most,
            CanTorque::TICK_RATE
        );
        refusals.add(key, reason);
    }
    let least = f64::from(OLDEST_ANSWER) / f64::from(OLDEST_SAMPLE);
    if tick_rate < least {
        let reason = format!(
            "is {tick_rate:?} Hz: the drives answer once in a tick, and a drive that is silent must be found within \
             {:.0} ms, {OLDEST_ANSWER} ticks; at least {:.0} Hz are needed",
            1e3 * f64::from(OLDEST_SAMPLE),
            least.ceil()
        );
        refusals.add(key, reason);
    }
}
