//! `[[actuator]]` as written: the keys of every kind of drive, and which kind takes which.

use super::actuator::{Actuator, CanTorque, Drive, HobbyServo, Stepper};
use super::drive_kind::DriveKind;
use super::hobby_servo;
use super::value::single;
use crate::refusal::{Key, Refusals};
use DriveKind::{Brushed, CanTorque as Can, Servo, Stepper as Steps};
use fivebar_firmware::drives::can::Protocol;
use fivebar_firmware::drives::can::mit::Ranges;
use fivebar_plant::{DriverMode, EncoderSide, Harmonics, Stepper as Motor};
use serde::Deserialize;

/// What a drive on a bus speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum ProtocolName {
    Odrive,
    Mit,
}

/// `[[actuator]]` with every key of every kind.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ActuatorFile {
    #[serde(default)]
    pub(super) kind: DriveKind,
    gear_ratio: Option<f64>,
    rotor_inertia: Option<f64>,
    torque_constant: Option<f64>,
    resistance: Option<f64>,
    inductance: Option<f64>,
    #[serde(default)]
    viscous_friction: f64,
    #[serde(default)]
    coulomb_friction: f64,
    #[serde(default)]
    brake_torque: f64,
    brake_engage_time: Option<f64>,
    brake_release_time: Option<f64>,
    encoder_counts: Option<u32>,
    peak_current: Option<f64>,
    continuous_current: Option<f64>,
    thermal_time_constant: Option<f64>,
    current_per_code: Option<f64>,
    stiffness: Option<f64>,
    drive_damping: Option<f64>,
    encoder_side: Option<EncoderSide>,
    encoder_latency: Option<f64>,
    encoder_error: Option<Harmonics>,
    steps_per_turn: Option<u32>,
    microsteps: Option<u32>,
    holding_torque: Option<f64>,
    rated_current: Option<f64>,
    detent_torque: Option<f64>,
    driver: Option<DriverMode>,
    torque_share: Option<f64>,
    protocol: Option<ProtocolName>,
    node: Option<u8>,
    peak_torque: Option<f64>,
    continuous_torque: Option<f64>,
    max_speed: Option<f64>,
    current_bandwidth: Option<f64>,
    position_range: Option<f64>,
    velocity_range: Option<f64>,
    torque_range: Option<f64>,
    pulse_range: Option<[f64; 2]>,
    travel: Option<f64>,
    middle_angle: Option<f64>,
    dead_band: Option<f64>,
    frame_rate: Option<f64>,
    stall_torque: Option<f64>,
}

/// Rows of keys of `$file` that not every kind takes: the name, whether the file gives it, and the kinds that take it.
macro_rules! keys_of {
    ($file:ident: $($name:ident [$($kind:ident),+])+) => {
        [$((stringify!($name), $file.$name.is_some(), [$($kind),+].as_slice())),+]
    };
}

/// Reads the keys of one section, and notes those that are missing.
struct Reader<'r> {
    index: usize,
    kind: DriveKind,
    refusals: &'r mut Refusals,
}

impl Reader<'_> {
    /// A key that this kind needs.
    fn needed(&mut self, name: &'static str, value: Option<f64>) -> f64 {
        value.unwrap_or_else(|| {
            let key = Key::Of("actuator", self.index, name);
            let reason = format!("is missing: a drive of kind \"{}\" needs it", self.kind);
            self.refusals.add(key, reason);
            f64::NAN
        })
    }
}

impl ActuatorFile {
    /// The keys that not every kind takes.
    fn of_some(&self) -> [(&'static str, bool, &'static [DriveKind]); 35] {
        keys_of! { self:
            torque_constant [Brushed, Can]
            encoder_counts [Brushed, Steps, Can]
            encoder_side [Brushed, Steps]
            encoder_latency [Brushed]
            encoder_error [Brushed, Can]
            peak_current [Brushed]
            continuous_current [Brushed]
            thermal_time_constant [Brushed]
            current_per_code [Brushed]
            resistance [Brushed, Steps]
            inductance [Brushed, Steps]
            stiffness [Brushed, Steps]
            drive_damping [Brushed, Steps]
            steps_per_turn [Steps]
            microsteps [Steps]
            holding_torque [Steps]
            rated_current [Steps]
            detent_torque [Steps]
            driver [Steps]
            torque_share [Steps, Servo]
            protocol [Can]
            node [Can]
            peak_torque [Can]
            continuous_torque [Can]
            max_speed [Can, Servo]
            current_bandwidth [Can]
            position_range [Can]
            velocity_range [Can]
            torque_range [Can]
            pulse_range [Servo]
            travel [Servo]
            middle_angle [Servo]
            dead_band [Servo]
            frame_rate [Servo]
            stall_torque [Servo]
        }
    }

    /// Whether the file gives a key that not every kind takes.
    pub(super) fn gives(&self, name: &str) -> bool {
        let is_there = |(of_some, is_given, _)| is_given && of_some == name;
        self.of_some().into_iter().any(is_there)
    }

    /// Keys of other kinds are refused, so that none is without effect.
    fn refuse_foreign(&self, index: usize, refusals: &mut Refusals) {
        let kind = self.kind;
        for (name, is_given, kinds) in self.of_some() {
            if !is_given || kinds.contains(&kind) {
                continue;
            }
            let of: Vec<String> = kinds.iter().map(|kind| format!("\"{kind}\"")).collect();
            let of = of.join(" or ");
            let reason = format!(
                "is a key of kind {of}, and this drive is of kind \"{kind}\": leave the key out, or write kind = {of}"
            );
            refusals.add(Key::Of("actuator", index, name), reason);
        }
    }

    /// The drive; what is missing, or of another kind, is noted, and the drive is then not complete.
    pub(super) fn actuator(self, index: usize, refusals: &mut Refusals) -> Actuator {
        self.refuse_foreign(index, refusals);
        let reader = &mut Reader {
            index,
            kind: self.kind,
            refusals,
        };
        match self.kind {
            DriveKind::Brushed => self.brushed(reader),
            DriveKind::Stepper => self.stepper(reader),
            DriveKind::CanTorque => self.can_torque(reader),
            DriveKind::Servo => self.hobby_servo(reader),
        }
    }

    fn brushed(self, reader: &mut Reader<'_>) -> Actuator {
        let counts = self.encoder_counts.map(f64::from);
        Actuator {
            torque_constant: reader.needed("torque_constant", self.torque_constant),
            // `as` cuts nothing: the counts were whole.
            encoder_counts: reader.needed("encoder_counts", counts) as u32,
            peak_current: reader.needed("peak_current", self.peak_current),
            continuous_current: reader.needed("continuous_current", self.continuous_current),
            thermal_time_constant: reader
                .needed("thermal_time_constant", self.thermal_time_constant),
            resistance: reader.needed("resistance", self.resistance),
            inductance: reader.needed("inductance", self.inductance),
            ..self.any(reader)
        }
    }

    /// A drive on a bus, as the motor that the rest of the program knows: currents are its torques over the torque
    /// constant, and its winding has the lag of its current loop.
    fn can_torque(self, reader: &mut Reader<'_>) -> Actuator {
        let protocol = self.protocol(reader);
        let node = reader.needed("node", self.node.map(f64::from)) as u8;
        let peak_torque = reader.needed("peak_torque", self.peak_torque);
        let continuous_torque = reader.needed("continuous_torque", self.continuous_torque);
        let max_speed = reader.needed("max_speed", self.max_speed);
        let torque_constant = self.torque_constant.unwrap_or(CanTorque::TORQUE_CONSTANT);
        let bandwidth = self
            .current_bandwidth
            .unwrap_or(CanTorque::CURRENT_BANDWIDTH);
        Actuator {
            torque_constant,
            resistance: CanTorque::RESISTANCE,
            inductance: CanTorque::RESISTANCE / bandwidth,
            encoder_counts: self
                .encoder_counts
                .unwrap_or_else(|| CanTorque::counts(&protocol)),
            peak_current: peak_torque / torque_constant,
            continuous_current: continuous_torque / torque_constant,
            thermal_time_constant: CanTorque::HEATING,
            drive: Drive::CanTorque(CanTorque {
                protocol,
                node,
                torque_constant: self.torque_constant,
                peak_torque,
                continuous_torque,
                max_speed,
                current_bandwidth: bandwidth,
            }),
            ..self.any(reader)
        }
    }

    /// The protocol, with the ranges of MIT-type drives.
    fn protocol(&self, reader: &mut Reader<'_>) -> Protocol {
        let ranges = [
            ("position_range", self.position_range),
            ("velocity_range", self.velocity_range),
            ("torque_range", self.torque_range),
        ];
        if self.protocol == Some(ProtocolName::Mit) {
            let [position, velocity, torque] =
                ranges.map(|(name, range)| single(reader.needed(name, range)));
            return Protocol::Mit(Ranges {
                position,
                velocity,
                torque,
            });
        }
        if self.protocol.is_none() {
            let key = Key::Of("actuator", reader.index, "protocol");
            let reason = "is missing: a drive of kind \"can-torque\" speaks \"odrive\" or \"mit\"";
            reader.refusals.add(key, reason);
        }
        for (name, _) in ranges.iter().filter(|(_, range)| range.is_some()) {
            let key = Key::Of("actuator", reader.index, name);
            let reason = "is a key of protocol \"mit\": with \"odrive\" leave it out";
            reader.refusals.add(key, reason);
        }
        Protocol::Odrive
    }

    /// A stepper, as the motor that the rest of the program knows: its holding torque at the rated current, and, without
    /// an encoder, one count a micro-step.
    fn stepper(self, reader: &mut Reader<'_>) -> Actuator {
        let holding_torque = reader.needed("holding_torque", self.holding_torque);
        let rated_current = reader.needed("rated_current", self.rated_current);
        let microsteps = reader.needed("microsteps", self.microsteps.map(f64::from)) as u32;
        let steps_per_turn = self.steps_per_turn.unwrap_or(Stepper::STEPS_PER_TURN);
        let detent_torque = self.detent_torque.unwrap_or(0.0);
        let torque_share = self.torque_share.unwrap_or(Stepper::TORQUE_SHARE);
        let driver = self.driver.unwrap_or_default();
        let resistance = reader.needed("resistance", self.resistance);
        let inductance = reader.needed("inductance", self.inductance);
        let encoder_counts = self.encoder_counts;
        if encoder_counts.is_none() && self.encoder_side.is_some() {
            let side = Key::Of("actuator", reader.index, "encoder_side");
            let reason = "needs `encoder_counts`: without it the stepper has no encoder";
            reader.refusals.add(side, reason);
        }
        let any = self.any(reader);
        let motor = Motor {
            steps_per_turn,
            microsteps,
            gear_ratio: any.gear_ratio,
            rotor_inertia: any.rotor_inertia,
            holding_torque,
            rated_current,
            resistance,
            inductance,
            detent_torque,
            encoder: encoder_counts.is_some(),
            driver,
        };
        Actuator {
            torque_constant: motor.torque_constant(),
            resistance,
            inductance,
            encoder_counts: encoder_counts
                .unwrap_or_else(|| steps_per_turn.saturating_mul(microsteps)),
            peak_current: rated_current,
            continuous_current: rated_current,
            thermal_time_constant: Stepper::HEATING,
            drive: Drive::Stepper(Stepper {
                motor,
                torque_share,
            }),
            ..any
        }
    }

    /// A hobby servo, as the motor that the rest of the program knows: currents are its torques over 1 N·m/A, and a count is
    /// a unit of the timer that makes its pulses.
    fn hobby_servo(mut self, reader: &mut Reader<'_>) -> Actuator {
        let missing = |reader: &mut Reader<'_>| [reader.needed("pulse_range", None); 2];
        let pulse_range = self.pulse_range.unwrap_or_else(|| missing(reader));
        let travel = reader.needed("travel", self.travel);
        let max_speed = reader.needed("max_speed", self.max_speed);
        let stall_torque = reader.needed("stall_torque", self.stall_torque);
        let dead_band = reader.needed("dead_band", self.dead_band);
        let servo = HobbyServo {
            pulse_range,
            travel,
            middle_angle: self.middle_angle,
            max_speed,
            stall_torque,
            dead_band,
            frame_rate: self.frame_rate.unwrap_or(hobby_servo::FRAME_RATE),
            torque_share: self.torque_share.unwrap_or(hobby_servo::TORQUE_SHARE),
        };
        self.gear_ratio = self.gear_ratio.or(Some(1.0));
        // A typical inertia beyond the sizes that files may have follows from a number that is refused by its own name.
        let typical = Some(servo.typical_inertia()).filter(|it| (1e-30..=1e30).contains(it));
        self.rotor_inertia = self.rotor_inertia.or(typical).or(Some(0.0));
        Actuator {
            torque_constant: CanTorque::TORQUE_CONSTANT,
            resistance: CanTorque::RESISTANCE,
            inductance: CanTorque::RESISTANCE / CanTorque::CURRENT_BANDWIDTH,
            encoder_counts: servo.units_per_turn(),
            peak_current: stall_torque / CanTorque::TORQUE_CONSTANT,
            continuous_current: stall_torque / CanTorque::TORQUE_CONSTANT,
            thermal_time_constant: CanTorque::HEATING,
            drive: Drive::HobbyServo(servo),
            ..self.any(reader)
        }
    }

    /// What every kind has.
    fn any(self, reader: &mut Reader<'_>) -> Actuator {
        Actuator {
            gear_ratio: reader.needed("gear_ratio", self.gear_ratio),
            rotor_inertia: reader.needed("rotor_inertia", self.rotor_inertia),
            torque_constant: 0.0,
            resistance: 0.0,
            inductance: 0.0,
            viscous_friction: self.viscous_friction,
            coulomb_friction: self.coulomb_friction,
            brake_torque: self.brake_torque,
            brake_engage_time: self.brake_engage_time,
            brake_release_time: self.brake_release_time,
            encoder_counts: 0,
            peak_current: 0.0,
            continuous_current: 0.0,
            thermal_time_constant: 0.0,
            current_per_code: self.current_per_code,
            stiffness: self.stiffness,
            drive_damping: self.drive_damping.unwrap_or_default(),
            encoder_side: self.encoder_side.unwrap_or_default(),
            encoder_latency: self.encoder_latency.unwrap_or_default(),
            encoder_error: self.encoder_error.unwrap_or_default(),
            drive: Drive::Brushed,
        }
    }
}
