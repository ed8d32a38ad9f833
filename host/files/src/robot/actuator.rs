//! What turns a driven joint, as a robot file gives it: what is known of it.

use fivebar_firmware::drives::can::Protocol;
use fivebar_plant::{
    Encoder, EncoderSide, Harmonics, Motor, Stepper as StepperMotor, Transmission,
};

/// `[[actuator]]`: the motor, gear, encoder and current sensor of one driven joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuator {
    /// Motor turns per joint turn, negative if the motor turns against its joint.
    pub gear_ratio: f64,
    /// Rotor inertia at the motor shaft [kg·m²].
    pub rotor_inertia: f64,
    /// Torque constant [N·m/A], equal to the back-EMF constant [V·s/rad].
    pub torque_constant: f64,
    /// Winding resistance [Ω].
    pub resistance: f64,
    /// Winding inductance [H].
    pub inductance: f64,
    /// Viscous friction at the joint [N·m·s/rad].
    pub viscous_friction: f64,
    /// Coulomb friction at the joint [N·m].
    pub coulomb_friction: f64,
    /// Torque of the holding brake at the joint [N·m]; zero without a brake. An upright arm
    /// without brakes falls while it is unpowered.
    pub brake_torque: f64,
    /// Longest time from switching the holding brake off to its full torque [s]; none:
    /// `BRAKE_TIME` with a brake, 0 without one.
    pub brake_engage_time: Option<f64>,
    /// Longest time from switching the holding brake on to a free joint [s]; likewise.
    pub brake_release_time: Option<f64>,
    /// Encoder counts per motor turn, after quadrature. For an encoder at the joint: its
    /// counts per turn over the gear ratio.
    pub encoder_counts: u32,
    /// Peak motor current [A].
    pub peak_current: f64,
    /// Continuous motor current [A].
    pub continuous_current: f64,
    /// Time constant of the motor's heating [s].
    pub thermal_time_constant: f64,
    /// Motor current per ADC code [A]; by default ±2 × `peak_current` fills 12 bits.
    pub current_per_code: Option<f64>,
    /// Stiffness of the gear or belt at the joint [N·m/rad]; none: rigid.
    pub stiffness: Option<f64>,
    /// Damping beside the stiffness, at the joint [N·m·s/rad].
    pub drive_damping: f64,
    /// The shaft that the encoder measures.
    pub encoder_side: EncoderSide,
    /// Age of the encoder's angle when it is sampled [s].
    pub encoder_latency: f64,
    /// The encoder's known error, an angle of the encoder's shaft [rad]: its measured angle is
    /// the true one plus this.
    pub encoder_error: Harmonics,
    /// What it has besides, by its kind.
    pub drive: Drive,
}

/// What a drive has besides, by its kind: what the rest of the program knows of a motor is its [`Actuator`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// Nothing: it is a brushed motor.
    Brushed,
    /// The holding torque is that at the peak current, and the counts are micro-steps.
    Stepper(Stepper),
    /// The currents are the torques over the torque constant, and the winding has the lag of the drive's current loop.
    CanTorque(CanTorque),
    /// The currents are the torques over 1 N·m/A, and the counts are units of the timer that makes the pulses.
    HobbyServo(HobbyServo),
}

/// Time in which a holding brake of this size engages or releases, if the file has none [s]: data
/// sheets of spring-applied brakes have 0.02 to 0.05 s.
pub(super) const BRAKE_TIME: f64 = 0.05;

impl Actuator {
    /// Its stepper, if it is one.
    pub fn stepper(&self) -> Option<&Stepper> {
        match &self.drive {
            Drive::Stepper(stepper) => Some(stepper),
            _ => None,
        }
    }

    /// Its drive on a bus, if it is one.
    pub fn can(&self) -> Option<&CanTorque> {
        match &self.drive {
            Drive::CanTorque(drive) => Some(drive),
            _ => None,
        }
    }

    /// The motor's torque constant [N·m/A], if it is a drive on a bus whose file states it.
    pub fn stated_torque_constant(&self) -> Option<f64> {
        self.can()?.torque_constant
    }

    /// Its hobby servo, if it is one.
    pub fn hobby_servo(&self) -> Option<&HobbyServo> {
        match &self.drive {
            Drive::HobbyServo(servo) => Some(servo),
            _ => None,
        }
    }

    /// The motor with its gear ratio and the friction at its joint.
    pub fn motor(&self) -> Motor {
        Motor {
            gear_ratio: self.gear_ratio,
            rotor_inertia: self.rotor_inertia,
            torque_constant: self.torque_constant,
            resistance: self.resistance,
            inductance: self.inductance,
            viscous_friction: self.viscous_friction,
            coulomb_friction: self.coulomb_friction,
        }
    }

    /// The gear or belt.
    pub fn transmission(&self) -> Transmission {
        Transmission {
            stiffness: self.stiffness,
            damping: self.drive_damping,
        }
    }

    /// The encoder, without its counts.
    pub fn encoder(&self) -> Encoder {
        Encoder {
            side: self.encoder_side,
            latency: self.encoder_latency,
            error: self.encoder_error,
        }
    }

    /// Longest times in which the holding brake engages and releases [s].
    pub fn brake_times(&self) -> [f64; 2] {
        let usual = if self.brake_torque > 0.0 {
            BRAKE_TIME
        } else {
            0.0
        };
        [self.brake_engage_time, self.brake_release_time].map(|time| time.unwrap_or(usual))
    }

    /// Torque at the joint at peak current [N·m].
    pub fn peak_torque(&self) -> f64 {
        self.peak_current * self.torque_per_ampere()
    }

    /// Torque at the joint per current, without sign [N·m/A].
    pub(super) fn torque_per_ampere(&self) -> f64 {
        self.torque_constant * self.gear_ratio.abs()
    }
}

/// A stepper, and how much of it a motion may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepper {
    /// The motor with its gear and the driver's micro-steps.
    pub motor: StepperMotor,
    /// Share of the pull-out torque that a motion may take.
    pub torque_share: f64,
}

/// A drive on a bus, and what it can. Torques and speeds are of its shaft, before `gear_ratio`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CanTorque {
    /// What it speaks.
    pub protocol: Protocol,
    /// Its number on the bus.
    pub node: u8,
    /// Torque constant of its motor [N·m/A], if the file states it; without one, a torque of 1 N·m is told as a current of
    /// 1 A.
    pub torque_constant: Option<f64>,
    /// [N·m].
    pub peak_torque: f64,
    /// [N·m].
    pub continuous_torque: f64,
    /// [rad/s].
    pub max_speed: f64,
    /// Bandwidth of its current loop [rad/s].
    pub current_bandwidth: f64,
}

/// A hobby servo, and how much of its torque a motion may take. Torque and speed are of its shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HobbyServo {
    /// Two widths of the pulse [s].
    pub pulse_range: [f64; 2],
    /// The angle by which the shaft turns between them [rad].
    pub travel: f64,
    /// The joint's angle at the middle of the widths [rad]; none: the middle of its limits.
    pub middle_angle: Option<f64>,
    /// At the nominal supply [rad/s].
    pub max_speed: f64,
    /// At the nominal supply [N·m].
    pub stall_torque: f64,
    /// Change of the width up to which it does not react [s].
    pub dead_band: f64,
    /// Pulses in a second [Hz].
    pub frame_rate: f64,
    /// Share of its torque that a motion may take.
    pub torque_share: f64,
}
