//! Transitions: only [`Controller::dispatch`] changes the state, by the table of
//! [`State::after`]. It also runs the entry action of the next state.

use super::ArmController;
use super::joint::Joint;
use crate::drives::{DriveReport, Drives, Needs};
use crate::safety::{Event, Fault, Response, State};

/// One joint in the tick that raised a fault.
#[derive(Clone)]
#[repr(C)]
pub(super) struct LatchedJoint {
    /// θ̂ [rad].
    pub(super) angle: f32,
    /// ω̂ [rad/s].
    pub(super) velocity: f32,
}

/// The latched fault and the tick that raised it: plain copies, so that latching takes few
/// instructions.
#[derive(Clone)]
#[repr(C)]
pub(super) struct Latched {
    pub(super) joints: [LatchedJoint; 2],
    /// Position errors [rad] as last computed.
    pub(super) error: [f32; 2],
    pub(super) drives: DriveReport,
    /// Ticks since the reset.
    pub(super) tick: u32,
    pub(super) fault: Fault,
    /// The state in which it was raised.
    pub(super) state: State,
}

impl LatchedJoint {
    #[inline(always)]
    fn of(joint: &Joint) -> Self {
        Self {
            angle: joint.angle(),
            velocity: joint.velocity(),
        }
    }
}

impl<D: Drives> ArmController<D> {
    /// Gives an event to the state machine. Requests check their conditions before they call it.
    ///
    /// # Errors
    /// The present state, unchanged, if it does not accept the event.
    // Inlined, so that each event in the tick compiles to its own case without a call.
    #[inline(always)]
    pub(super) fn dispatch(&mut self, event: Event) -> Result<(), State> {
        let before = self.state;
        let next = before.after(event).ok_or(before)?;
        self.state = next;
        if before == State::Crossing && !matches!(next, State::Crossing | State::Armed) {
            self.forget_assembly();
        }
        match (next, event) {
            (State::Stopped, Event::Clear) => {
                self.come_to_stopped();
                self.drives.clear_errors();
            }
            (State::Stopped, _) => self.come_to_stopped(),
            (State::Homing, _) => self.start_homing(),
            // Segments pushed behind the end of the path stay queued until more come.
            (State::Armed, Event::Finish) => self.path.finish(),
            (State::Armed, Event::Stop | Event::Rest) => self.forget_path(),
            (State::Stopping, _) => self.path.brake(),
            (State::Compliant, Event::Stop) => self.touch.end(),
            (State::Fault, _) if self.controlled_stop => self.path.brake(),
            (
                State::Armed
                | State::Running
                | State::Exciting
                | State::Crossing
                | State::Compliant
                | State::Fault,
                _,
            ) => {}
        }
        Ok(())
    }

    /// Latches a fault with a snapshot of the present values, and enters [`State::Fault`]; the
    /// next tick switches the bridges off. The first fault stays latched; a power-off fault
    /// replaces one that only holds the arm.
    #[cold]
    #[inline(never)]
    pub fn latch_fault(&mut self, fault: Fault) {
        match (fault.response(), self.state) {
            (
                Response::ControlledStop,
                State::Armed | State::Running | State::Stopping | State::Compliant,
            ) => self.begin_controlled_stop(fault),
            (Response::ControlledStop, State::Fault) => {
                let _ = self.dispatch(Event::Fault);
            }
            // A controlled stop needs a path, or a position to hold.
            (
                Response::ControlledStop,
                State::Stopped | State::Homing | State::Exciting | State::Crossing,
            ) => self.latch_power_off(fault),
            (Response::PowerOff, _) => self.latch_power_off(fault),
        }
    }

    /// Latches a fault for which the bridges are switched off.
    #[inline(never)]
    pub(super) fn latch_power_off(&mut self, fault: Fault) {
        if self.latched.is_none() || self.controlled_stop {
            self.latched = Some(self.snapshot(fault));
            self.controlled_stop = false;
        }
        if fault.loses_angles() {
            self.homed = false;
        }
        // Every state accepts this event.
        let _ = self.dispatch(Event::Fault);
    }

    /// Latches a fault for which the arm stops on its path and is held. It takes the place of one
    /// that holds the arm already.
    pub(super) fn begin_controlled_stop(&mut self, fault: Fault) {
        self.brake.stay_powered();
        self.latched = Some(self.snapshot(fault));
        self.controlled_stop = true;
        // Every state accepts this event.
        let _ = self.dispatch(Event::Fault);
    }

    /// Latches a fault as [`Self::begin_controlled_stop`] does, where the stop has begun.
    #[inline(always)]
    pub(super) fn latch_stop(&mut self, fault: Fault) {
        self.brake.stay_powered();
        self.latched = Some(self.snapshot(fault));
        // So the transition leaves the path alone.
        self.controlled_stop = false;
        // Every state accepts this event.
        let _ = self.dispatch(Event::Fault);
        self.controlled_stop = true;
    }

    /// The present values, for a fault.
    #[inline(always)]
    fn snapshot(&self, fault: Fault) -> Latched {
        let [joint1, joint4] = &self.joints;
        Latched {
            joints: [LatchedJoint::of(joint1), LatchedJoint::of(joint4)],
            error: self.error,
            drives: self.drives.report(),
            tick: self.ticks,
            fault,
            state: self.state,
        }
    }

    /// The arm has come to rest: at the end of its path, after a stop, or where it has given way.
    #[inline(always)]
    pub(super) fn come_to_rest(&mut self) {
        // Each state has its own call, so that only its own transition is compiled into it. They
        // accept their event.
        match self.state {
            State::Running => {
                let _ = self.dispatch(Event::Finish);
            }
            State::Stopping => {
                let _ = self.dispatch(Event::Rest);
            }
            // Other drives do not get into it.
            State::Compliant if D::NEEDS == Needs::Torque => {
                let _ = self.dispatch(Event::Rest);
            }
            // The arm is held until the fault is cleared.
            State::Fault => self.forget_path(),
            State::Stopped
            | State::Homing
            | State::Exciting
            | State::Crossing
            | State::Compliant
            | State::Armed => {}
        }
    }

    /// Whether the arm still moves while a fault is latched: its controlled stop is not over.
    pub(super) fn moves_under_fault(&self) -> bool {
        self.controlled_stop && !self.path.is_empty()
    }

    /// Entry of Stopped: clears the fault and the path; the joints start at rest at their counts. Whoever
    /// asks for power in the same tick wakes the bridges and releases the brakes anew.
    fn come_to_stopped(&mut self) {
        self.waking = self.model.wake_up_ticks;
        self.brake.stay_powered();
        self.latched = None;
        self.controlled_stop = false;
        self.forget_path();
        for (joint, model) in self.joints.iter_mut().zip(&self.model.axes) {
            joint.settle(model);
        }
        self.drives.release();
    }

    /// After a crossing that did not end well the arm's assembly mode is unknown: it is homed again, in
    /// that of the settings.
    #[cold]
    #[inline(never)]
    fn forget_assembly(&mut self) {
        self.model.assembly = self.settings.assembly();
        self.homed = false;
    }

    /// Drops the path, and switches the tool off. The new path generation shows the planner that its plan is out of date.
    #[inline]
    pub(super) fn forget_path(&mut self) {
        self.path_generation = self.path_generation.wrapping_add(1);
        self.path.clear();
    }
}
