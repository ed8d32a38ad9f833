//! The arm with two hobby servos, one tick at a time.
//!
//! It is a [`Plant`] whose bridges are off, as an arm with steppers is; the servos' torques act on its joints. The timer
//! that makes the pulses is here too: the controller's micro-steps are its units.

use super::servo::{Electronics, HobbyServo};
use crate::mismatch::Mismatch;
use crate::parameters::Parameters;
use crate::plant::Plant;
use crate::wiring::{StepWires, Wiring};
use fivebar_firmware::drives::{BrushedCommand, StepCommand, StepSample};
use fivebar_firmware::{ActuatorCommand, ArmCommand, ArmSample};
use fivebar_kinematics::five_bar::{Joint, Pose};
use nalgebra::Vector2;

/// The longest integration step [s]: a twentieth of the time in which a servo's speed follows.
const LONGEST_STEP: f64 = 5e-5;

/// An arm with two hobby servos.
#[derive(Clone, Debug)]
pub struct HobbyServoPlant {
    arm: Plant,
    axes: [Axis; 2],
    wires: StepWires,
    nominal_voltage: f64,
    /// The supply has been so high that the electronics of both servos are broken.
    is_broken: bool,
}

/// One servo with the timer that makes its pulses.
#[derive(Clone, Debug)]
struct Axis {
    servo: HobbyServo,
    /// The joint's angle at the width of home [rad].
    home: f64,
    /// Units of the timer by which the pulse is longer than at home.
    units: i32,
    /// Time until the next pulse begins [s].
    until_pulse: f64,
    /// The pulse that is on its way: the time until its end [s], and its width [s].
    pulse: Option<(f64, f64)>,
    /// The width that the servo has read [s]; none before the first pulse.
    read: Option<f64>,
    /// Its torque [N·m].
    torque: f64,
}

impl HobbyServoPlant {
    /// The arm with these servos and this mismatch, at rest in `pose`, without pulses. Gear ratio and inertia are the
    /// servos', friction and supply those of `parameters`; an excess of the torque constant is one of the stall torque, and
    /// an error of home one of the angle at which a horn sits on its servo.
    /// `seed` starts the sensors' noise.
    pub fn new(
        parameters: &Parameters,
        servos: &[HobbyServo; 2],
        mismatch: &Mismatch,
        pose: &Pose<f64>,
        seed: u64,
    ) -> Self {
        let rotors = servos.map(|servo| (servo.gear_ratio, servo.rotor_inertia));
        let arm = Plant::with_other_motors(parameters, rotors, mismatch, pose, seed);
        let axes = Joint::ALL.map(|j| {
            let mut servo = servos[j];
            servo.stall_torque *= 1.0 + mismatch.torque_constant[j];
            Axis {
                servo,
                home: f64::from(parameters.settings.axes[j].home_angle) + mismatch.home_error[j],
                units: 0,
                until_pulse: 0.0,
                pulse: None,
                read: None,
                torque: 0.0,
            }
        });
        Self {
            arm,
            axes,
            wires: StepWires::default(),
            nominal_voltage: parameters.bus_voltage,
            is_broken: false,
        }
    }

    /// Wires the arm like this from now on.
    pub fn rewire(&mut self, wiring: &Wiring) {
        self.arm.rewire(wiring);
        self.wires.rewire(wiring);
    }

    /// Advances by one tick of `period` [s], and by the ticks that the controller misses, in which the pulses stay as long
    /// as they are. The units of a tick are in the pulses that begin after it. Without power a servo gets no pulse and
    /// gives no torque.
    pub fn step(&mut self, command: &ArmCommand<StepCommand>, period: f64) {
        for _ in 0..=self.arm.begin_tick() {
            self.tick(command, period);
        }
        let units = self.wires.turn(command.drives.steps);
        for (axis, units) in self.axes.iter_mut().zip(units) {
            axis.units += units;
        }
    }

    fn tick(&mut self, command: &ArmCommand<StepCommand>, period: f64) {
        let bridges_off = ActuatorCommand {
            drives: BrushedCommand::default(),
            enable: [false; 2],
            brake: command.brake,
            tool: command.tool,
        };
        let parts = (period / LONGEST_STEP).ceil().max(1.0);
        let time = period / parts;
        let enable = self.wires.enabled(command.enable);
        for _ in 0..parts as u32 {
            let volts = self.wires.supply_share() * self.arm.bus_voltage();
            let electronics = Electronics::on(volts);
            self.is_broken |= electronics == Electronics::Broken;
            let works = electronics == Electronics::Work && !self.is_broken;
            let supply = volts / self.nominal_voltage;
            let torque = Joint::ALL.map(|j| {
                let powered = enable[j] && self.arm.is_powered(j);
                let (angle, speed) = self.arm.rotor(j);
                let axis = &mut self.axes[j];
                axis.receive(powered && works, time);
                axis.drive(angle, speed, supply);
                axis.servo.gear_ratio * axis.torque
            });
            if let Some(drives) = &mut self.arm.drives {
                drives.motor_torque = torque;
            }
            self.arm.advance(&bridges_off, time);
        }
    }

    /// Samples all sensors at once; the counts are the units of the timer.
    pub fn sense(&mut self) -> ArmSample<StepSample> {
        let sample = self.arm.sense();
        let units = self.wires.counted();
        ArmSample {
            counts: units,
            drives: StepSample {
                steps: units,
                ..StepSample::default()
            },
            home: sample.home,
            index: sample.index,
            emergency_stop: sample.emergency_stop,
            driver_fault: sample.driver_fault,
            missed_ticks: sample.missed_ticks,
        }
    }

    /// The widths of the pulses that begin now [s].
    pub fn width(&self) -> [f64; 2] {
        self.axes.each_ref().map(Axis::width)
    }

    /// The servos' torques at the joints [N·m].
    pub fn torque(&self) -> [f64; 2] {
        self.axes
            .each_ref()
            .map(|axis| axis.servo.gear_ratio * axis.torque)
    }

    /// The arm with its sensors.
    pub fn arm(&self) -> &Plant {
        &self.arm
    }

    /// The arm, to push its tool or inject faults.
    pub fn arm_mut(&mut self) -> &mut Plant {
        &mut self.arm
    }

    /// True angle of a driven joint [rad].
    pub fn angle(&self, joint: Joint) -> f64 {
        self.arm.angle(joint)
    }

    /// True position of the tool [m].
    pub fn tool(&self) -> Vector2<f64> {
        self.arm.tool()
    }
}

impl Axis {
    fn width(&self) -> f64 {
        let [one, other] = self.servo.pulse_range;
        let width = self.servo.home_width + f64::from(self.units) * HobbyServo::UNIT;
        width.clamp(one.min(other), one.max(other))
    }

    /// The pulses of this time [s]: one begins in each frame, and the servo knows its width when it ends.
    fn receive(&mut self, powered: bool, time: f64) {
        if !powered {
            (self.until_pulse, self.pulse, self.read) = (0.0, None, None);
            return;
        }
        if self.until_pulse <= 0.0 {
            let width = self.width();
            self.pulse = Some((width, width));
            self.until_pulse += 1.0 / self.servo.frame_rate;
        }
        self.until_pulse -= time;
        if let Some((until_end, width)) = self.pulse {
            self.pulse = Some((until_end - time, width));
            if until_end <= time {
                (self.pulse, self.read) = (None, Some(width));
            }
        }
    }

    /// The torque at this angle of the joint [rad] and its speed [rad/s].
    fn drive(&mut self, angle: f64, speed: f64, supply: f64) {
        let Self { servo, .. } = self;
        self.torque = self.read.map_or(0.0, |width| {
            let wanted = (width - servo.home_width) * servo.angle_per_width();
            let error = wanted - servo.gear_ratio * (angle - self.home);
            servo.torque(error, servo.gear_ratio * speed, supply)
        });
    }
}
