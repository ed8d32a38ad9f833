//! The tick: sensor sample in, actuator command out.

use super::ArmController;
use super::setpoint::Setpoint;
use crate::drives::{Demand, Drives, Motion, Needs, UnpoweredPlace};
use crate::io::{ArmCommand, ArmSample};
use crate::safety::{Fault, Limits, State, TOLERATED_TICKS};
use fivebar_kinematics::five_bar;

/// The torques that the joints should give.
#[derive(Clone, Copy)]
pub(super) struct TorqueCommand {
    /// τ1, τ4 [N·m].
    pub(super) torque: [f32; 2],
    /// The limits that have clipped so far.
    pub(super) limits: Limits,
}

/// What a tick does besides monitoring.
#[derive(Clone, Copy)]
pub(super) enum ControlMode {
    /// Nothing: the bridges are off.
    Off,
    /// Wait: the bridges wake up; or excite a motor, when they are awake.
    Waking,
    /// Look for the home switches.
    Homing,
    /// Cross a singularity.
    Crossing,
    /// Give way to forces on the arm.
    Compliant,
    /// Hold or follow the path.
    Tracking,
}

impl ControlMode {
    /// Whether the bridges are on.
    #[inline(always)]
    pub(super) fn is_powered(self) -> bool {
        match self {
            Self::Off => false,
            Self::Waking | Self::Homing | Self::Crossing | Self::Compliant | Self::Tracking => true,
        }
    }
}

/// What the drives do in a tick without a reference.
pub(super) enum UnpoweredOutput {
    /// They are off.
    Off,
    /// They wake up.
    Waking,
    /// They do what an excitation asks for.
    Excited,
}

/// What the tick measured, for the detection of faults.
pub(super) struct Measurement {
    pub(super) innovation: [f32; 2],
    pub(super) velocity: [f32; 2],
}

impl<D: Drives> ArmController<D> {
    /// Runs one tick. The returned command acts from the next tick on.
    ///
    /// When the bridges are switched on, they are given [`WAKE_UP_TIME`]: the duties are zero, the
    /// brake stays engaged, the loops stay cleared, and the bridges' fault outputs are not
    /// judged. Then they hold the arm while the brake is released. A path or a search for the
    /// switches begins when it is free.
    ///
    /// [`WAKE_UP_TIME`]: Drives::WAKE_UP_TIME
    ///
    /// The work is bounded: the only loops are over the two joints and over at most two
    /// segments of the path.
    pub fn tick(&mut self, sample: &ArmSample<D::Sample>) -> ArmCommand<D::Command> {
        let measurement = self.measure(sample);
        // Every fault that is found before the end of the tick switches the bridges off, and the
        // tick ends with it: so its longest path holds one fault.
        let mode = self.control_mode();
        if sample.missed_ticks > TOLERATED_TICKS && mode.is_powered() {
            self.overrun(self.unpowered_fault(sample, measurement.innovation));
            return self.off();
        }
        if let ControlMode::Off | ControlMode::Waking = mode {
            return match self.follow_nothing(sample, measurement, mode) {
                UnpoweredOutput::Off => self.off(),
                UnpoweredOutput::Waking => self.waking(),
                UnpoweredOutput::Excited => self.excited(),
            };
        }
        let fault = self.fault_in_sample(sample, &measurement);
        if let Some(fault) = fault.or_else(|| self.contradiction()) {
            self.power_off(fault);
            return self.off();
        }
        if let Some(verdict) = self.brake.take_verdict() {
            return self.end_test(verdict, sample);
        }
        let torques = match mode {
            ControlMode::Off | ControlMode::Waking => return self.off(),
            ControlMode::Homing => self.home(sample),
            ControlMode::Crossing => self.cross().map(Some),
            ControlMode::Compliant => self.comply().map(Some),
            ControlMode::Tracking => self.track().map(Some),
        };
        let torques = match torques {
            Ok(Some(torques)) => torques,
            Ok(None) => {
                self.unpowered();
                return self.off();
            }
            Err(fault) => {
                self.power_off(fault);
                return self.off();
            }
        };
        let Some(mut command) = self.drive(torques) else {
            // The next tick latches the fault: this one has taken long enough.
            self.pending_off = Some(Fault::NotANumber);
            return self.off();
        };
        self.note_pulses(sample);
        self.run_time_slice(sample);
        command.tool = self.path.tool_output();
        command
    }

    /// Runs a tick while the board's clock has failed: latches that fault, and the bridges are off. A tick of
    /// its own, so that the longest one does not latch a fault before its work.
    #[cold]
    #[inline(never)]
    pub fn tick_without_clock(&mut self, sample: &ArmSample<D::Sample>) -> ArmCommand<D::Command> {
        self.latch_fault(Fault::ClockFailure);
        let measurement = self.measure(sample);
        self.follow_nothing(sample, measurement, ControlMode::Off);
        self.off()
    }

    #[inline(always)]
    fn measure(&mut self, sample: &ArmSample<D::Sample>) -> Measurement {
        self.ticks = self.ticks.wrapping_add(1);
        self.missed_ticks = self.missed_ticks.wrapping_add(sample.missed_ticks);
        self.drives.sense(&sample.drives);
        let [joint1, joint4] = &mut self.joints;
        let [model1, model4] = &self.model.axes;
        // Of the moment that the observer observes.
        let alpha1 = self
            .setpoint_history
            .alpha(five_bar::Joint::Joint1, &model1.servo.age);
        let alpha4 = self
            .setpoint_history
            .alpha(five_bar::Joint::Joint4, &model4.servo.age);
        let [counts1, counts4] = self.drives.counts(sample.counts);
        let innovation = [
            joint1.measure(model1, counts1, alpha1),
            joint4.measure(model4, counts4, alpha4),
        ];
        Measurement {
            innovation,
            velocity: [joint1.velocity(), joint4.velocity()],
        }
    }

    /// What the tick does in this state.
    #[inline(always)]
    pub(super) fn control_mode(&self) -> ControlMode {
        match self.state {
            State::Stopped => ControlMode::Off,
            State::Fault if !self.controlled_stop => ControlMode::Off,
            State::Armed | State::Homing | State::Crossing | State::Fault if self.waking > 0 => {
                ControlMode::Waking
            }
            State::Exciting => ControlMode::Waking,
            State::Homing => ControlMode::Homing,
            State::Crossing => ControlMode::Crossing,
            // Other drives do not get into this state, so their images have no code for it.
            State::Compliant => match D::NEEDS {
                Needs::Torque => ControlMode::Compliant,
                Needs::Motion => ControlMode::Off,
            },
            State::Armed | State::Running | State::Stopping | State::Fault => ControlMode::Tracking,
        }
    }

    /// Whether the bridges are on.
    #[inline(always)]
    pub(super) fn is_powered(&self) -> bool {
        self.control_mode().is_powered()
    }

    /// Lets the drives make the torques. This is the last check before them: none where an output is not
    /// a number.
    #[inline(always)]
    fn drive(&mut self, command: TorqueCommand) -> Option<ArmCommand<D::Command>> {
        let share = self.brake.share;
        let Setpoint {
            direction: [u1, u4],
            omega,
            alpha,
        } = self.setpoint;
        let limited = self.drives.drive(&Demand {
            torque: command.torque.map(|torque| share * torque),
            keeps_to_motion: share >= 1.0 && self.keeps_to_motion(),
            velocity: self.velocities(),
            counted: self.counted(),
            motion: Motion {
                direction: [u1.into(), u4.into()],
                velocity: omega,
                acceleration: alpha,
            },
        });
        let limits = match D::NEEDS {
            Needs::Torque => command.limits,
            // The torque is the motors' own affair.
            Needs::Motion => command.limits.difference(Limits::TORQUE),
        };
        self.limits = limits.with(Limits::VOLTAGE, limited);
        if !self.drives.is_finite() {
            self.release_loops();
            self.path.switch_tool_off();
            return None;
        }
        Some(ArmCommand {
            drives: self.drives.command(),
            enable: [true; 2],
            brake: self.brake.is_on(),
            // Of the end of the tick.
            tool: 0,
        })
    }

    /// Whether the arm follows its path, or is held.
    #[inline(always)]
    fn keeps_to_motion(&self) -> bool {
        match self.state {
            State::Armed | State::Running | State::Stopping | State::Fault => true,
            State::Stopped
            | State::Homing
            | State::Exciting
            | State::Crossing
            | State::Compliant => false,
        }
    }

    /// Too many missed ticks, and what else was found: the observer and the loops have lost the
    /// arm's motion. An emergency stop in the same tick is the fault that is reported.
    #[cold]
    #[inline(never)]
    fn overrun(&mut self, other: Option<Fault>) {
        if other != Some(Fault::EmergencyStop) {
            self.latch_power_off(Fault::TickOverrun);
        }
        match other {
            Some(fault) => self.power_off(fault),
            None => self.unpowered(),
        }
    }

    /// A fault that switches the bridges off.
    #[cold]
    #[inline(never)]
    pub(super) fn power_off(&mut self, fault: Fault) {
        self.latch_power_off(fault);
        self.unpowered();
    }

    /// A tick with the bridges off, in which the emergency stop and an encoder jump are faults, or
    /// one in which they wake up or excite a motor. Returns what they do after it. The first tick with counts
    /// takes them as the origin.
    #[inline(never)]
    fn follow_nothing(
        &mut self,
        sample: &ArmSample<D::Sample>,
        mut measurement: Measurement,
        mode: ControlMode,
    ) -> UnpoweredOutput {
        self.forget_rest();
        self.cool();
        if !self.begun {
            self.begun = self.drives.tell_counts();
            measurement.innovation = [0.0; 2];
            measurement.velocity = [0.0; 2];
            for ((joint, axis), counts) in self
                .joints
                .iter_mut()
                .zip(&self.model.axes)
                .zip(self.drives.counts(sample.counts))
            {
                joint.begin(axis, counts);
            }
        }
        if self.state == State::Exciting && self.waking == 0 {
            return self.excite(sample, &measurement);
        }
        let wakes = mode.is_powered();
        let mut fault = self.unpowered_fault(sample, measurement.innovation);
        if wakes {
            fault = fault.or_else(|| self.measured_fault(&measurement));
        }
        match fault {
            Some(fault) => {
                self.power_off(fault);
                UnpoweredOutput::Off
            }
            None if wakes => {
                self.waking = self.waking.saturating_sub(1);
                if self.waking == 0 {
                    self.brake.release();
                }
                self.drives.wake(self.drives.counts(sample.counts));
                self.release();
                UnpoweredOutput::Waking
            }
            None => {
                self.drives.rest(&sample.drives);
                self.unpowered();
                UnpoweredOutput::Off
            }
        }
    }

    /// The bridges go off, or are off: an arm whose place nothing shows then is not homed any more.
    #[inline(always)]
    pub(super) fn unpowered(&mut self) {
        if self.drives.unpowered_place() != UnpoweredPlace::Kept {
            self.homed = false;
        }
        self.waking = self.model.wake_up_ticks;
        self.brake.lose_power();
        self.release();
        self.path.switch_tool_off();
    }

    /// Bridges off, brake on, tool off.
    #[inline(always)]
    pub(super) fn off(&self) -> ArmCommand<D::Command> {
        ArmCommand {
            drives: self.drives.unpowered(),
            enable: [false; 2],
            brake: true,
            tool: self.path.tool_output(),
        }
    }

    /// Bridges on, which do not drive yet; brake on.
    #[inline(always)]
    fn waking(&self) -> ArmCommand<D::Command> {
        ArmCommand {
            enable: [true; 2],
            ..self.off()
        }
    }

    /// Clears the loops; the set-point stays at rest where it is.
    fn release(&mut self) {
        self.limits = Limits::empty();
        self.at_rest = false;
        self.pending_stop = None;
        self.pending_off = None;
        self.setpoint.rest();
        self.setpoint_history.restart();
        self.release_loops();
    }

    /// Clears the loops of joints and drives.
    #[inline(always)]
    pub(super) fn release_loops(&mut self) {
        self.drives.release();
        for joint in &mut self.joints {
            joint.release();
        }
    }
}

#[cfg(test)]
mod tests;
