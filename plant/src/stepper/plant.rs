//! The arm with two stepper motors, one tick at a time.
//!
//! It is a [`Plant`] whose bridges are off: links, friction, belts, brakes, switches, encoders and faults are the same.
//! The motors' torques act on its rotors. A tick is cut into steps of at most 5 µs, each with one step of the
//! mechanics, by the torque in its middle (θ + ω Δt/2, which neither damps nor excites a rotor), and one of the windings.

use super::motor::Stepper;
use super::windings::Windings;
use crate::drives::{Drives, Energy};
use crate::mismatch::Mismatch;
use crate::parameters::Parameters;
use crate::plant::Plant;
use fivebar_firmware::drives::{BrushedCommand, Resolution, StepCommand, StepSample};
use fivebar_firmware::{ActuatorCommand, ArmCommand, ArmSample};
use fivebar_kinematics::five_bar::{Joint, Pose};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// The longest integration step [s]: an edge of 200,000 micro-steps a second, and 0.1 rad of the field at the highest
/// speed of a common motor.
const LONGEST_STEP: f64 = 5e-6;

/// An arm with two stepper motors behind drivers with step and direction.
#[derive(Clone, Debug)]
pub struct StepperPlant {
    arm: Plant,
    axes: [Axis; 2],
    /// Of the windings alone.
    energy: Energy,
}

/// One motor with its driver.
#[derive(Clone, Debug)]
struct Axis {
    motor: Stepper,
    windings: Windings,
    /// The micro-steps made; they never wrap.
    made: i64,
    /// Of these, those that the driver missed.
    missed: i64,
    /// Pulses that the driver is going to miss.
    to_miss: u32,
    /// The motor's angle at the start, which is a full step [rad].
    start: f64,
}

impl StepperPlant {
    /// The arm with these motors and this mismatch, at rest in `pose`. There each rotor is at a full step, and so is
    /// its field. Gear ratio and rotor inertia are the steppers', friction, belts and bus voltage those of `parameters`;
    /// an excess of the torque constant is one of the holding torque. `seed` starts the sensors' noise.
    pub fn new(
        parameters: &Parameters,
        steppers: &[Stepper; 2],
        mismatch: &Mismatch,
        pose: &Pose<f64>,
        seed: u64,
    ) -> Self {
        let rotors = steppers.map(|stepper| (stepper.gear_ratio, stepper.rotor_inertia));
        let arm = Plant::with_other_motors(parameters, rotors, mismatch, pose, seed);
        let axes = Joint::ALL.map(|j| {
            let mut motor = steppers[j];
            motor.holding_torque *= 1.0 + mismatch.torque_constant[j];
            Axis {
                motor,
                windings: Windings::default(),
                made: 0,
                missed: 0,
                to_miss: 0,
                start: motor.gear_ratio * arm.angle(j),
            }
        });
        Self {
            arm,
            axes,
            energy: Energy::default(),
        }
    }

    /// Advances by one tick of `period` [s], and by the ticks that the controller misses, in which no step is made.
    /// The edges of a tick are evenly spread over it. Without power a motor has no current: its driver returns it to the
    /// supply.
    pub fn step(&mut self, command: &ArmCommand<StepCommand>, period: f64) {
        let missed = self.arm.begin_tick();
        for j in Joint::ALL {
            let full_steps = std::mem::take(&mut self.arm.faults.missed_steps[j]);
            self.axes[j].to_miss += full_steps * self.axes[j].motor.microsteps;
        }
        self.tick(command, command.drives.steps, period);
        for _ in 0..missed {
            self.tick(command, [0; 2], period);
        }
    }

    fn tick(&mut self, command: &ArmCommand<StepCommand>, steps: [i32; 2], period: f64) {
        let bridges_off = ActuatorCommand {
            drives: BrushedCommand::default(),
            enable: [false; 2],
            brake: command.brake,
            tool: command.tool,
        };
        let before = self.axes.each_ref().map(|axis| axis.made);
        let parts = (period / LONGEST_STEP).ceil().max(1.0);
        let time = period / parts;
        for part in 1..=parts as u32 {
            self.turn_rotors(&bridges_off, time);
            for j in Joint::ALL {
                self.axes[j].make(before[j] + made(steps[j], f64::from(part) / parts));
                let powered = command.enable[j] && self.arm.is_powered(j);
                self.drive(j, powered, time);
            }
        }
    }

    /// One step of the mechanics by the motors' torques in the middle of it.
    fn turn_rotors(&mut self, command: &ActuatorCommand, time: f64) {
        let torque = Joint::ALL.map(|j| {
            let (angle, speed) = self.rotor(j);
            let Axis {
                motor, windings, ..
            } = &self.axes[j];
            motor.gear_ratio * windings.torque(motor, angle + 0.5 * time * speed)
        });
        if let Some(drives) = &mut self.arm.drives {
            drives.motor_torque = torque;
        }
        self.arm.advance(command, time);
    }

    /// One step of a motor's windings.
    fn drive(&mut self, joint: Joint, powered: bool, time: f64) {
        let rotor = self.rotor(joint);
        let supply = self.arm.bus_voltage();
        let axis = &mut self.axes[joint];
        let motor = &axis.motor;
        let current = if powered { motor.rated_current } else { 0.0 };
        let (sin, cos) = libm::sincos(motor.field(axis.made - axis.missed));
        let set_point = [current * cos, current * sin];
        let Energy { supplied, lost } = axis.windings.step(motor, set_point, rotor, supply, time);
        self.energy.supplied += supplied;
        self.energy.lost += lost;
    }

    /// The motor's angle from the full step of the start [rad], and its speed [rad/s].
    fn rotor(&self, joint: Joint) -> (f64, f64) {
        let Axis { motor, start, .. } = &self.axes[joint];
        let (angle, speed) = self.arm.rotor(joint);
        (motor.gear_ratio * angle - start, motor.gear_ratio * speed)
    }

    /// Samples all sensors at once.
    pub fn sense(&mut self) -> ArmSample<StepSample> {
        let sample = self.arm.sense();
        // The driver's counter has 32 bits.
        let steps = self.axes.each_ref().map(|axis| axis.made as i32);
        let counts = Joint::ALL.map(|j| {
            if self.axes[j].motor.encoder {
                sample.counts[j]
            } else {
                steps[j]
            }
        });
        ArmSample {
            counts,
            drives: StepSample {
                steps,
                resolution: self.axes.each_ref().map(Axis::resolution),
            },
            home: sample.home,
            index: sample.index,
            emergency_stop: sample.emergency_stop,
            driver_fault: sample.driver_fault,
            missed_ticks: sample.missed_ticks,
        }
    }

    /// The full steps by which each rotor is ahead of the micro-steps made: those by which it slipped from the field,
    /// in fours, and those that its driver missed.
    pub fn lost_steps(&self) -> [i64; 2] {
        Joint::ALL.map(|j| {
            let axis = &self.axes[j];
            let microsteps = i64::from(axis.motor.microsteps);
            let field = (axis.made - axis.missed) as f64 / microsteps as f64;
            let rotor = self.rotor(j).0 / TAU * f64::from(axis.motor.steps_per_turn);
            let slipped = 4 * ((rotor - field) / 4.0).round() as i64;
            slipped - axis.missed / microsteps
        })
    }

    /// The motors' torques at the joints [N·m].
    pub fn torque(&self) -> [f64; 2] {
        Joint::ALL.map(|j| {
            let Axis {
                motor, windings, ..
            } = &self.axes[j];
            motor.gear_ratio * windings.torque(motor, self.rotor(j).0)
        })
    }

    /// The length of each motor's vector of currents [A].
    pub fn current(&self) -> [f64; 2] {
        self.axes.each_ref().map(|axis| axis.windings.current())
    }

    /// The arm with its sensors.
    pub fn arm(&self) -> &Plant {
        &self.arm
    }

    /// The arm, to press its switches, push its tool or inject faults.
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

    /// The energies that were supplied and lost.
    pub fn energy(&self) -> Energy {
        let drives = self.arm.drives().map(Drives::energy).unwrap_or_default();
        Energy {
            supplied: self.energy.supplied + drives.supplied,
            lost: self.energy.lost + drives.lost,
        }
    }

    /// Energy in the arm, the rotors, the springs, the windings and the detents [J].
    pub fn stored(&self) -> f64 {
        let (model, state) = (self.arm.model(), self.arm.state());
        let arm = self.arm.drives().map(|drives| drives.stored(model, state));
        let motor = |j: Joint| {
            let Axis {
                motor, windings, ..
            } = &self.axes[j];
            windings.energy(motor) + motor.detent_energy(self.rotor(j).0)
        };
        let [motor1, motor4] = Joint::ALL.map(motor);
        arm.unwrap_or_default() + motor1 + motor4
    }
}

impl Axis {
    /// As a board tells it: nothing of a motor without an encoder.
    fn resolution(&self) -> Resolution {
        let motor = &self.motor;
        if !motor.encoder {
            return Resolution::default();
        }
        // The checks of a robot file keep both below 65,536.
        Resolution {
            full_steps: motor.steps_per_turn as u16,
            microsteps: motor.microsteps as u16,
        }
    }

    /// Makes the micro-steps up to this one.
    fn make(&mut self, made: i64) {
        let steps = made - self.made;
        let missed = steps.unsigned_abs().min(self.to_miss.into());
        self.to_miss -= missed as u32;
        self.missed += missed as i64 * steps.signum();
        self.made = made;
    }
}

/// The steps of a tick that are made after this share of it: edge k of n at (k − ½)/n.
fn made(steps: i32, share: f64) -> i64 {
    (f64::from(steps) * share).round() as i64
}

#[cfg(test)]
mod tests {
    use super::made;

    #[test]
    fn edges_are_evenly_spread() {
        for steps in [1, 7, 20] {
            for edge in 1..=steps {
                let at = (f64::from(edge) - 0.5) / f64::from(steps);
                for (share, expected) in [(at - 1e-9, edge - 1), (at + 1e-9, edge)] {
                    assert_eq!(made(steps, share), i64::from(expected));
                    assert_eq!(made(-steps, share), -i64::from(expected));
                }
            }
            assert_eq!(made(steps, 1.0), i64::from(steps));
        }
    }
}
