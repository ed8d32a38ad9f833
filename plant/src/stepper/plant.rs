//! The arm with two stepper motors, one tick at a time.
//!
//! It is a [`Plant`] whose bridges are off: links, friction, belts, brakes, switches, encoders and faults are the same.
//! The motors' torques act on its rotors. A tick is cut into equal steps of the mechanics, and each of these into equal
//! steps of the windings, whose currents change much faster than the arm moves. First the windings take their steps, while
//! each rotor goes on at its speed. Then the mean of their torques drives the mechanics through the same time. For a
//! spring, the mean of the torques along θ + ω t is the torque in the middle, θ + ω Δt/2, which neither damps nor excites
//! a rotor.

use super::motor::{DriverMode, Stepper};
use super::windings::{Rotor, Windings};
use crate::drives::{Drives, Energy};
use crate::dynamics::SHORTEST_STEP;
use crate::mismatch::Mismatch;
use crate::parameters::Parameters;
use crate::plant::Plant;
use crate::wiring::{StepWires, Wiring};
use fivebar_firmware::drives::{BrushedCommand, Resolution, StepCommand, StepSample};
use fivebar_firmware::{ActuatorCommand, ArmCommand, ArmSample};
use fivebar_kinematics::five_bar::{Joint, Pose};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// The longest step of the windings [s]: an edge of 200,000 micro-steps a second, and 0.1 rad of the field at the highest
/// speed of a common motor.
const WINDINGS: f64 = 5e-6;
/// The longest step of the mechanics [s]: 0.1 rad of the swing of a common motor's rotor that turns nothing else.
const MECHANICS: f64 = 50e-6;
/// The greatest phase of a rotor's swing in one step of the mechanics [rad]. The swing is then faster by 1/24 of its
/// square, 0.05 %. A common motor's rotor swings by this in 50 µs, so a tick of 100 µs has two steps of the mechanics.
const PHASE: f64 = 0.11;

/// The time in which a driver in voltage mode sees that its micro-steps come at another speed [s]: five at the slowest
/// speed at which their lag matters, 5 rad/s with 16 of them in a full step.
const SPEED_FILTER: f64 = 2e-3;

/// An arm with two stepper motors behind drivers with step and direction.
#[derive(Clone, Debug)]
pub struct StepperPlant {
    arm: Plant,
    axes: [Axis; 2],
    wires: StepWires,
    /// The longest steps of mechanics and windings [s].
    longest: [f64; 2],
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
    /// The direction of the field after the steps made, as its cosine and sine.
    field: [f64; 2],
    /// The motor's speed at which the field turns, as its driver sees it [rad/s].
    field_speed: f64,
    /// The motor's acceleration in the latest step of the mechanics [rad/s²].
    acceleration: f64,
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
                start: motor.gear_ratio * arm.rotor_angle(j),
                field: [1.0, 0.0],
                field_speed: 0.0,
                acceleration: 0.0,
            }
        });
        let swings = axes.each_ref().map(|axis| axis.motor.fastest_swing());
        let mechanics = MECHANICS.min(PHASE / swings[0].max(swings[1]));
        Self {
            arm,
            axes,
            wires: StepWires::default(),
            longest: [mechanics.max(SHORTEST_STEP), WINDINGS],
            energy: Energy::default(),
        }
    }

    /// The same arm, integrated in half the steps: by how much it then moves differently shows how exact the steps are.
    #[must_use]
    pub fn with_finer_steps(mut self) -> Self {
        self.longest = self.longest.map(|step| 0.5 * step);
        self
    }

    /// Wires the arm like this from now on.
    pub fn rewire(&mut self, wiring: &Wiring) {
        self.arm.rewire(wiring);
        self.wires.rewire(wiring);
        for j in Joint::ALL {
            self.arm.faults.disconnected[j] |= wiring.motor_dead[j];
            self.arm.faults.phase_open[j] |= wiring.phase_dead[j];
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
        let steps = self.wires.turn(command.drives.steps);
        self.tick(command, steps, period);
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
        let [mechanics, windings] = self.longest;
        let (parts, time) = equal_parts(period, mechanics);
        let (in_part, winding_time) = equal_parts(time, windings);
        let before = self.axes.each_ref().map(|axis| axis.made);
        let enable = self.wires.enabled(command.enable);
        for part in 0..parts {
            let torque = Joint::ALL.map(|j| {
                let powered = enable[j] && self.arm.is_powered(j);
                let made = (part * in_part..(part + 1) * in_part).map(|step| {
                    let share = f64::from(step + 1) / f64::from(parts * in_part);
                    before[j] + made(steps[j], share)
                });
                self.drive(j, powered, made, winding_time)
            });
            if let Some(drives) = &mut self.arm.drives {
                drives.motor_torque = torque;
            }
            let speed = Joint::ALL.map(|j| self.rotor(j).1);
            self.arm.advance(&bridges_off, time);
            for j in Joint::ALL {
                self.axes[j].acceleration = (self.rotor(j).1 - speed[j]) / time;
            }
        }
    }

    /// Steps of `time` [s] of a motor's windings, at the ends of which so many micro-steps are made. Until then the rotor
    /// turns on: its angle at its speed, and for the back-EMF its speed at its latest acceleration, without which the
    /// work of the motor would not be that of the supply. Returns the mean torque at the joint [N·m].
    fn drive(
        &mut self,
        joint: Joint,
        powered: bool,
        made: impl ExactSizeIterator<Item = i64>,
        time: f64,
    ) -> f64 {
        let (angle, speed) = self.rotor(joint);
        let supply = self.wires.supply_share() * self.arm.bus_voltage();
        let (axis, wires) = (&mut self.axes[joint], &self.wires);
        let motor = axis.motor;
        let is_open = self.arm.faults.phase_open[joint];
        let half = 0.5 * time;
        let half_a_step = Rotor::new(&motor, half * speed, half * axis.acceleration);
        let mut rotor = Rotor::new(&motor, angle, speed);
        let (mut torque, steps) = (0.0, made.len() as f64);
        for made in made {
            rotor = rotor.turned(&half_a_step);
            torque += axis.windings.torque(&motor, &rotor);
            rotor = rotor.turned(&half_a_step);
            axis.make(made, time);
            let along_field = |length| wires.phases(joint, axis.field.map(|share| length * share));
            let Energy { supplied, lost } = match (powered, motor.driver) {
                (true, DriverMode::Voltage) => {
                    let voltage = motor.regulated_voltage(axis.field_speed).min(supply);
                    let voltage = along_field(voltage);
                    axis.windings
                        .step_under_voltage(&motor, voltage, &rotor, time)
                }
                (true, DriverMode::Current) => {
                    let set_point = along_field(motor.rated_current);
                    axis.windings.step(&motor, set_point, &rotor, supply, time)
                }
                (false, _) => axis.windings.step(&motor, [0.0; 2], &rotor, supply, time),
            };
            if is_open {
                axis.windings.phases[1] = 0.0;
            }
            self.energy.supplied += supplied;
            self.energy.lost += lost;
        }
        motor.gear_ratio * torque / steps
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
        let steps = self.wires.counted();
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
            let (angle, speed) = self.rotor(j);
            motor.gear_ratio * windings.torque(motor, &Rotor::new(motor, angle, speed))
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

    /// Makes the micro-steps up to this one within `time` [s].
    fn make(&mut self, made: i64, time: f64) {
        let steps = made - self.made;
        let step = TAU / (f64::from(self.motor.steps_per_turn) * f64::from(self.motor.microsteps));
        let share = time / (SPEED_FILTER + time);
        self.field_speed += share * (steps as f64 * step / time - self.field_speed);
        let missed = steps.unsigned_abs().min(self.to_miss.into());
        self.to_miss -= missed as u32;
        self.missed += missed as i64 * steps.signum();
        self.made = made;
        if steps != 0 {
            let (sin, cos) = libm::sincos(self.motor.field(self.made - self.missed));
            self.field = [cos, sin];
        }
    }
}

/// The least number of equal parts of a time [s] that are no longer than `longest` [s], and how long each is [s].
fn equal_parts(time: f64, longest: f64) -> (u32, f64) {
    // A quotient that is a whole number but for its rounding is that number.
    let parts = (time / longest - 1e-9).ceil().max(1.0);
    (parts as u32, time / parts)
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
