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
        let controlled_stop = match fault.response() {
            Response::PowerOff => false,
            // A controlled stop needs a path, or a position to hold.
            Response::ControlledStop => match self.state {
                State::Armed | State::Running | State::Stopping => true,
                State::Fault => self.controlled_stop,
                State::Stopped | State::Homing => false,
            },
        };
        if self.latched.is_none() || (self.controlled_stop && !controlled_stop) {
            self.latched = Some(Snapshot {
                fault,
                tick: self.ticks,
                state: self.state,
                angle: self.angles(),
                velocity: self.velocities(),
                error: self.error,
                current: self.joints.each_ref().map(|joint| joint.current),
                torque: self.torques(),
                bus_voltage: self.bus_voltage,
            });
            self.controlled_stop = controlled_stop;
        }
        if fault.loses_angles() {
            self.homed = false;
        }
        // Every state accepts this event.
        let _ = self.dispatch(Event::Fault);
    }

    /// The arm has come to rest: at the end of its path, or after a stop.
    #[cold]
    pub(super) fn come_to_rest(&mut self) {
        let event = match self.state {
            State::Running => Event::Finish,
            State::Stopping => Event::Rest,
            // The arm is held until the fault is cleared.
            State::Fault => return self.forget_path(),
            State::Stopped | State::Homing | State::Armed => return,
        };
        let _ = self.dispatch(event);
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

    /// Drops the path. The new path generation shows the planner that its plan is out of date.
    fn forget_path(&mut self) {
        self.path_generation = self.path_generation.wrapping_add(1);
        self.path.clear();
    }
}
