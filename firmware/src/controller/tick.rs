//! The tick: samples in, bridge commands out.

use super::Controller;
use super::model::DUTY_LIMIT;
use crate::io::{Command, Sensed};
use crate::safety::{Fault, Limits, State};
use fivebar_kinematics::control::Bus;

/// What the joints are to give.
#[derive(Clone, Copy)]
pub(super) struct TorqueCommand {
    /// τ1, τ4 [N·m].
    pub(super) torque: [f32; 2],
    /// What has clipped so far.
    pub(super) limits: Limits,
}

/// What a tick has to do besides watching.
enum ControlMode {
    /// Nothing: the bridges are off.
    Off,
    /// Look for the home switches.
    Homing,
    /// Hold or follow the path.
    Tracking,
}

/// What one tick's samples say that may be a fault.
pub(super) struct Samples {
    pub(super) innovation: [f32; 2],
    pub(super) current: [f32; 2],
    pub(super) velocity: [f32; 2],
    pub(super) too_hot: bool,
}

impl Controller {
    /// One tick: what the bridges are told until the next.
    ///
    /// Bounded: no loop but over the two joints and at most two segments of path. The
    /// outputs act from the next tick on.
    pub fn tick(&mut self, sensed: &Sensed) -> Command {
        self.ticks = self.ticks.wrapping_add(1);
        self.bus_voltage = f32::from(sensed.bus_voltage) * self.model.bus_voltage_per_code;
        let samples = self.measure(sensed);
        if sensed.missed_ticks > 0 {
            self.overrun(sensed.missed_ticks);
        }
        if let Some(fault) = self.sampled_fault(sensed, &samples) {
            self.latch_fault(fault);
        }
        let torques = match self.control_mode() {
            ControlMode::Off => Ok(None),
            ControlMode::Homing => self.home(sensed).map(Some),
            ControlMode::Tracking => self.track().map(Some),
        };
        let command = match torques {
            Ok(Some(torques)) => self.drive(torques),
            Ok(None) => self.off(),
            Err(fault) => {
                self.latch_fault(fault);
                self.off()
            }
        };
        if let Some(fault) = self.stopping_fault() {
            self.latch_fault(fault);
        }
        command
    }

    #[inline(always)]
    fn measure(&mut self, sensed: &Sensed) -> Samples {
        let [joint1, joint4] = &mut self.joints;
        let [model1, model4] = &self.model.axes;
        let observer = &self.model.observer;
        let [alpha1, alpha4] = self.setpoint.alpha;
        let [counts1, counts4] = sensed.counts;
        let [current1, current4] = sensed.current;
        if !self.begun {
            self.begun = true;
            joint1.begin(counts1);
            joint4.begin(counts4);
        }
        let innovation = [
            joint1.measure(observer, model1, counts1, current1, alpha1),
            joint4.measure(observer, model4, counts4, current4, alpha4),
        ];
        // Motors warm slowly: each is looked at in every other tick.
        let too_hot = if self.ticks & 1 == 0 {
            joint1.warm(model1)
        } else {
            joint4.warm(model4)
        };
        Samples {
            innovation,
            current: [joint1.current, joint4.current],
            velocity: [joint1.velocity(), joint4.velocity()],
            too_hot,
        }
    }

    /// What a tick has to do in this state.
    #[inline(always)]
    fn control_mode(&self) -> ControlMode {
        match self.state {
            State::Armed | State::Running | State::Stopping => ControlMode::Tracking,
            State::Fault if self.controlled_stop => ControlMode::Tracking,
            State::Homing => ControlMode::Homing,
            State::Stopped | State::Fault => ControlMode::Off,
        }
    }

    /// Whether the bridges are on.
    #[inline(always)]
    pub(super) fn is_powered(&self) -> bool {
        match self.control_mode() {
            ControlMode::Off => false,
            ControlMode::Homing | ControlMode::Tracking => true,
        }
    }

    /// Sets the current loops to work. The last check before the bridges: nothing that is
    /// not a number gets past it.
    #[inline(always)]
    fn drive(&mut self, command: TorqueCommand) -> Command {
        let bus = Bus::new(self.bus_voltage, DUTY_LIMIT);
        let [joint1, joint4] = &mut self.joints;
        let [model1, model4] = &self.model.axes;
        let [torque1, torque4] = command.torque;
        let limited1 = joint1.drive(model1, torque1, &bus);
        let limited4 = joint4.drive(model4, torque4, &bus);
        self.limits = command.limits.with(Limits::VOLTAGE, limited1 || limited4);
        let duty = [joint1.duty, joint4.duty];
        // Both are within ±1 or not numbers, and so is their sum.
        let [duty1, duty4] = duty;
        if !(duty1 + duty4).is_finite() {
            self.latch_fault(Fault::NotANumber);
            return self.off();
        }
        Command {
            duty,
            enable: [true; 2],
            brake: false,
        }
    }

    /// Bridges off, brake on.
    fn off(&mut self) -> Command {
        self.limits = Limits::NONE;
        self.setpoint.rest();
        for joint in &mut self.joints {
            joint.release();
        }
        Command {
            duty: [0.0; 2],
            enable: [false; 2],
            brake: true,
        }
    }
}
