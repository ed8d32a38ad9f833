//! The arm with two torque drives on a bus, one tick at a time.
//!
//! It is a [`Plant`] whose bridges are off, as an arm with steppers is; the drives' torques act on its rotors. A tick is
//! cut where a frame ends: there a drive takes its input over, or senses its motor and puts its answer on the bus; and
//! where the drives' own loops have their turns.

use super::bus::Bus;
use super::drive::{CanDrive, DriveOnBus, PERIOD};
use super::protocol::{Answer, Order, answer, by_itself, orders};
use super::wires::Wires;
use crate::mismatch::Mismatch;
use crate::parameters::Parameters;
use crate::plant::Plant;
use crate::wiring::Wiring;
use fivebar_design::Noise;
use fivebar_firmware::drives::BrushedCommand;
use fivebar_firmware::drives::can::{Frame, Protocol, odrive};
use fivebar_firmware::settings::{HomingMethod, Share};
use fivebar_firmware::{ActuatorCommand, ArmSample};
use fivebar_kinematics::five_bar::{Joint, Pose};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// What is left of a time by rounding is shorter [s].
pub(super) const SHORTEST_STEP: f64 = 1e-12;
/// The controller as a sender on the bus; the drives follow.
pub(super) const CONTROLLER: usize = 0;

/// An arm with two torque drives on a CAN bus.
#[derive(Clone, Debug)]
pub struct CanPlant {
    pub(super) arm: Plant,
    pub(super) protocol: Protocol,
    pub(super) drives: [DriveOnBus; 2],
    pub(super) bus: Bus,
    /// Frames that the controller has received since it last took them.
    pub(super) received: Vec<Frame>,
    /// Counts per turn of each drive's shaft, and the counts where it tells 0.
    pub(super) counts_per_turn: [f64; 2],
    pub(super) zero: [i32; 2],
    /// Of the settings [N·m/A].
    torque_constant: [f64; 2],
    /// By this factor the drives make other torques than they tell.
    pub(super) torque_factor: [f64; 2],
    /// Time until each drive sends its next frame by itself [s].
    pub(super) until_told: [f64; 2],
    /// Time until the drives' loops have their next turn, and from one to the next, by the controller's clock [s].
    until_turn: f64,
    turn: f64,
    /// What is wrong with the wires, and whether it spoils the frame that is on its way.
    pub(super) wires: Wires,
    pub(super) is_spoilt: bool,
    /// The share of the frames that an error hits.
    error_share: f64,
    pub(super) noise: Noise,
    /// The least and the greatest time by which each drive's answers are late [s], and those that wait for it.
    pub(super) delay: [[f64; 2]; 2],
    late: [Vec<(f64, Frame)>; 2],
    /// Which drives tell the same answers again and again, and these.
    pub(super) repeats: [bool; 2],
    pub(super) repeated: [Vec<Frame>; 2],
    pub(super) wiring: Wiring,
}

impl CanPlant {
    /// The arm with these drives and this mismatch, at rest in `pose`. Gear ratio and inertia are the drives', and they
    /// tell the angles without the latency of `parameters`: their bus has its own. An excess of the torque constant is
    /// one of the torque. `seed` starts the noise.
    pub fn new(
        parameters: &Parameters,
        (protocol, drives): (Protocol, [CanDrive; 2]),
        mismatch: &Mismatch,
        pose: &Pose<f64>,
        seed: u64,
    ) -> Self {
        let mut parameters = parameters.clone();
        for encoder in &mut parameters.encoders {
            encoder.latency = 0.0;
        }
        let rotors = drives.map(|drive| (drive.gear_ratio, drive.rotor_inertia));
        let mut arm = Plant::with_other_motors(&parameters, rotors, mismatch, pose, seed);
        let settings = &parameters.settings;
        let zero = match settings.home_reference.method {
            HomingMethod::Absolute => [0; 2],
            _ => arm.sense().counts,
        };
        let follows = protocol != Protocol::Odrive;
        Self {
            arm,
            protocol,
            drives: drives.map(|drive| DriveOnBus::new(drive, follows)),
            bus: Bus::default(),
            received: Vec::new(),
            counts_per_turn: settings.axes.map(|axis| axis.encoder_counts.into()),
            zero,
            torque_constant: settings.axes.map(|axis| axis.torque_constant.into()),
            torque_factor: mismatch.torque_constant.map(|excess| 1.0 + excess),
            until_told: [0.0; 2],
            until_turn: 0.0,
            turn: PERIOD,
            wires: Wires::Whole,
            is_spoilt: false,
            error_share: 0.0,
            noise: Noise::new(seed),
            delay: [[0.0; 2]; 2],
            late: [Vec::new(), Vec::new()],
            repeats: [false; 2],
            repeated: [Vec::new(), Vec::new()],
            wiring: Wiring::default(),
        }
    }

    /// Lets the drives' clocks be slower than the controller's by this share, so that their loops turn at other times of each
    /// tick.
    pub fn slow_down(&mut self, share: f64) {
        self.turn = PERIOD * (1.0 + share);
    }

    /// Lets errors hit this share of the frames, which are then sent again.
    pub fn disturb(&mut self, share: f64) {
        self.error_share = share;
    }

    /// Advances by one tick of `period` [s], at whose beginning the controller sends these frames, and by the ticks that
    /// it misses, in which it sends none.
    pub fn step(&mut self, frames: &[Frame], brake: bool, tool: Share, period: f64) {
        let missed = self.follow_faults();
        if self.is_bus_off() {
            self.bus.forget(CONTROLLER);
        } else {
            for &frame in frames {
                self.bus.put(CONTROLLER, frame);
            }
        }
        let command = command(brake, tool);
        for _ in 0..=missed {
            self.tick(&command, period);
        }
    }

    /// Lets the drives follow the faults that are due. Returns how many ticks the controller misses.
    pub(super) fn follow_faults(&mut self) -> u32 {
        let missed = self.arm.begin_tick();
        for j in Joint::ALL {
            if self.arm.faults.cut_off[j] {
                self.drives[j].cut_off();
                self.late[j].clear();
                self.bus.forget(sender(j));
            }
            if std::mem::take(&mut self.arm.faults.resets[j]) {
                self.drives[j].reset();
                self.late[j].clear();
                self.bus.forget(sender(j));
            }
        }
        missed
    }

    fn tick(&mut self, command: &ActuatorCommand, period: f64) {
        self.beat(period);
        let mut left = period;
        while left > SHORTEST_STEP {
            let (share, noise) = (self.error_share, &mut self.noise);
            self.bus.begin(|| share > 0.0 && noise.uniform() < share);
            let (step, ended) = self.slice(command, left);
            left -= step;
            if let Some((from, frame)) = ended {
                self.arrive(from, &frame);
            }
        }
    }

    /// Lets this time pass for what the drives send by themselves [s].
    pub(super) fn beat(&mut self, time: f64) {
        for j in Joint::ALL {
            self.until_told[j] -= time;
            if self.until_told[j] <= 0.0 && !self.drives[j].is_silent() {
                self.until_told[j] += f64::from(odrive::PERIOD);
                let told = self.told(j);
                if let Some(frame) = by_itself(&self.protocol, &told) {
                    self.bus.put(sender(j), frame);
                }
            }
        }
    }

    /// Lets this time pass [s], at most to the next turn of the drives' loops, or to the end of the frame on its way. Returns the
    /// time, and the frame that has ended with its sender.
    pub(super) fn slice(
        &mut self,
        command: &ActuatorCommand,
        most: f64,
    ) -> (f64, Option<(usize, Frame)>) {
        if self.until_turn < SHORTEST_STEP {
            self.until_turn += self.turn;
            for j in Joint::ALL {
                let turns = self.turns(j);
                self.drives[j].turn(turns);
            }
        }
        let step = most.min(self.until_turn);
        let step = self.bus.time_left().map_or(step, |end| end.min(step));
        let step = step.min(self.until_late());
        self.advance(command, step);
        self.until_turn -= step;
        self.put_late(step);
        (step, self.bus.pass(step))
    }

    /// Time until an answer that is late comes [s].
    pub(super) fn until_late(&self) -> f64 {
        let times = self.late.iter().flatten().map(|&(left, _)| left);
        times.fold(f64::INFINITY, f64::min).max(SHORTEST_STEP)
    }

    /// Lets this time pass for answers that are late [s].
    fn put_late(&mut self, time: f64) {
        for j in Joint::ALL {
            for (left, _) in &mut self.late[j] {
                *left -= time;
            }
            let due = self.late[j].extract_if(.., |(left, _)| *left <= SHORTEST_STEP);
            for (_, frame) in due {
                self.bus.put(sender(j), frame);
            }
        }
    }

    /// One step of the mechanics by the drives' torques.
    fn advance(&mut self, command: &ActuatorCommand, time: f64) {
        let torque = Joint::ALL.map(|j| {
            let is_powered = self.arm.is_powered(j);
            let factor = self.torque_per_drive(j);
            factor * self.drives[j].pass(time, is_powered)
        });
        if let Some(drives) = &mut self.arm.drives {
            drives.motor_torque = torque;
        }
        self.arm.advance(command, time);
    }

    /// A frame has gone over the bus.
    pub(super) fn arrive(&mut self, from: usize, frame: &Frame) {
        if from != CONTROLLER {
            self.receive(from, *frame);
            return;
        }
        for j in Joint::ALL {
            let orders = orders(&self.protocol, frame, self.drives[j].drive.node);
            if self.drives[j].is_silent() || orders.is_empty() || self.misses_order(j) {
                continue;
            }
            for order in orders {
                self.drives[j].apply(order);
                if order == Order::Tell {
                    let told = self.told(j);
                    let answer = answer(&self.protocol, &told);
                    let [least, greatest] = self.delay[j];
                    if greatest > 0.0 {
                        let delay = least + (greatest - least) * self.noise.uniform();
                        self.late[j].push((delay, answer));
                    } else {
                        self.bus.put(sender(j), answer);
                    }
                }
            }
        }
    }

    /// What a drive tells now.
    fn told(&mut self, joint: Joint) -> Answer {
        let turns = self.turns(joint);
        let drive = &self.drives[joint];
        let (_, speed) = self.arm.rotor(joint);
        Answer {
            node: drive.drive.node,
            turns,
            speed: self.direction(joint) * drive.drive.gear_ratio * speed / TAU,
            torque: drive.torque(),
            drives: drive.drives(),
            error: drive.is_in_error(),
        }
    }

    /// Turns of a drive's shaft, as its encoder counts them.
    fn turns(&mut self, joint: Joint) -> f64 {
        let counts = self.arm.sense().counts[joint].wrapping_sub(self.zero[joint]);
        self.direction(joint) * f64::from(counts) / self.counts_per_turn[joint]
    }

    /// Samples the sensors that do not belong to the drives. The counts are 0.
    pub fn sense(&mut self) -> ArmSample<()> {
        let sample = self.arm.sense();
        ArmSample {
            counts: [0; 2],
            drives: (),
            home: sample.home,
            index: sample.index,
            emergency_stop: sample.emergency_stop,
            driver_fault: sample.driver_fault,
            missed_ticks: sample.missed_ticks,
        }
    }

    /// The frames that the controller has received since the last call.
    pub fn take_received(&mut self) -> Vec<Frame> {
        std::mem::take(&mut self.received)
    }

    /// Whether the controller has left the bus.
    pub fn is_bus_off(&self) -> bool {
        self.arm.faults.bus_off
    }

    /// The drives' torques at the joints [N·m].
    pub fn torque(&self) -> [f64; 2] {
        Joint::ALL.map(|j| self.torque_per_drive(j) * self.drives[j].torque())
    }

    /// The drives' torques over the torque constants of the settings [A].
    pub fn current(&self) -> [f64; 2] {
        Joint::ALL.map(|j| self.drives[j].torque() / self.torque_constant[j])
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
}

/// The command of an arm whose bridges are off.
pub(super) fn command(brake: bool, tool: Share) -> ActuatorCommand {
    ActuatorCommand {
        drives: BrushedCommand::default(),
        enable: [false; 2],
        brake,
        tool,
    }
}

/// A joint's drive as a sender on the bus.
pub(super) fn sender(joint: Joint) -> usize {
    1 + joint.index()
}
