//! Transitions: only [`Controller::dispatch`] changes the state, by the table of
//! [`State::after`]. It also runs the entry action of the next state.

use super::{Controller, Snapshot};
use crate::safety::{Event, Fault, Response, State};

impl Controller {
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
        match (next, event) {
            (State::Stopped, _) => self.come_to_stopped(),
            (State::Homing, _) => self.start_homing(),
            // Segments pushed behind the end of the path stay queued until more come.
            (State::Armed, Event::Finish) => self.path.finish(),
            (State::Armed, Event::Stop | Event::Rest) => self.forget_path(),
            (State::Stopping, _) => self.path.brake(),
            (State::Fault, _) if self.controlled_stop => self.path.brake(),
            (State::Armed | State::Running | State::Fault, _) => {}
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
            (Response::ControlledStop, State::Armed | State::Running | State::Stopping) => {
                self.begin_controlled_stop(fault);
            }
            (Response::ControlledStop, State::Fault) => {
                let _ = self.dispatch(Event::Fault);
            }
            // A controlled stop needs a path, or a position to hold.
            (Response::ControlledStop, State::Stopped | State::Homing) => {
                self.latch_power_off(fault);
            }
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

    /// Latches a fault for which the arm stops on its path and is held: in Armed, Running and
    /// Stopping, where no fault is latched.
    #[cold]
    #[inline(never)]
    pub(super) fn begin_controlled_stop(&mut self, fault: Fault) {
        self.latched = Some(self.snapshot(fault));
        self.controlled_stop = true;
        // Every state accepts this event.
        let _ = self.dispatch(Event::Fault);
    }

    /// The present values, for a fault.
    #[inline(always)]
    fn snapshot(&self, fault: Fault) -> Snapshot {
        Snapshot {
            fault,
            tick: self.ticks,
            state: self.state,
            angle: self.angles(),
            velocity: self.velocities(),
            error: self.error,
            current: self.joints.each_ref().map(|joint| joint.current),
            torque: self.torques(),
            bus_voltage: self.bus_voltage,
        }
    }

    /// The arm has come to rest: at the end of its path, or after a stop.
    #[cold]
    pub(super) fn come_to_rest(&mut self) {
        self.at_rest = false;
        // Each state has its own call, so that only its own transition is compiled into it. Both
        // accept their event.
        match self.state {
            State::Running => {
                let _ = self.dispatch(Event::Finish);
            }
            State::Stopping => {
                let _ = self.dispatch(Event::Rest);
            }
            // The arm is held until the fault is cleared.
            State::Fault => self.forget_path(),
            State::Stopped | State::Homing | State::Armed => {}
        }
    }

    /// Whether the arm still moves while a fault is latched: its controlled stop is not over.
    pub(super) fn moves_under_fault(&self) -> bool {
        self.controlled_stop && !self.path.is_empty()
    }

    /// Entry of Stopped: clears the fault and the path; the joints start at rest at their counts.
    fn come_to_stopped(&mut self) {
        self.latched = None;
        self.controlled_stop = false;
        self.forget_path();
        for (joint, model) in self.joints.iter_mut().zip(&self.model.axes) {
            joint.settle(model);
        }
    }

    /// Drops the path, and switches the tool off. The new path generation shows the planner that its plan is out of date.
    #[cold]
    #[inline(never)]
    pub(super) fn forget_path(&mut self) {
        self.path_generation = self.path_generation.wrapping_add(1);
        self.path.clear();
    }
}
