//! The one door for events: only [`Controller::dispatch`] changes the state, by the table of
//! [`State::after`], and does what the next state needs at its entry.

use super::{Controller, Snapshot};
use crate::safety::{Event, Fault, Response, State};

impl Controller {
    /// Gives an event to the state machine. What a request has to check beforehand, it has
    /// checked.
    ///
    /// # Errors
    /// The state, unchanged, where it refuses the event or the event means nothing to it.
    // Inlined, so that an event of the tick costs its own case and no call.
    #[inline(always)]
    pub(super) fn dispatch(&mut self, event: Event) -> Result<(), State> {
        let before = self.state;
        let next = before.after(event).ok_or(before)?;
        self.state = next;
        match (next, event) {
            (State::Stopped, _) => self.come_to_stopped(),
            (State::Homing, _) => self.start_homing(),
            // What was handed over behind the end waits for more.
            (State::Armed, Event::Finish) => self.path.finish(),
            (State::Armed, Event::Stop | Event::Rest) => self.forget_path(),
            (State::Stopping, _) => self.path.brake(),
            (State::Fault, _) if self.controlled_stop => self.path.brake(),
            (State::Armed | State::Running | State::Fault, _) => {}
        }
        Ok(())
    }

    /// Latches a fault with a snapshot of how things stand, so that no request gets in
    /// between; the next tick unpowers the bridges. The first fault stays latched; one that
    /// powers off replaces one that only stops the arm.
    #[cold]
    #[inline(never)]
    pub fn latch_fault(&mut self, fault: Fault) {
        let controlled_stop = match fault.response() {
            Response::PowerOff => false,
            // What stops under control needs a path or a place to hold.
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
        // Every state takes it.
        let _ = self.dispatch(Event::Fault);
    }

    /// The arm has come to rest, at the end of its path or braked.
    #[cold]
    pub(super) fn come_to_rest(&mut self) {
        let event = match self.state {
            State::Running => Event::Finish,
            State::Stopping => Event::Rest,
            // Held until the fault is cleared.
            State::Fault => return self.forget_path(),
            State::Stopped | State::Homing | State::Armed => return,
        };
        let _ = self.dispatch(event);
    }

    /// Whether the arm still comes to rest under a latched fault.
    pub(super) fn moves_under_fault(&self) -> bool {
        self.controlled_stop && !self.path.is_empty()
    }

    /// Entry of Stopped: no fault, no path, and joints that start from their counts.
    fn come_to_stopped(&mut self) {
        self.latched = None;
        self.controlled_stop = false;
        self.forget_path();
        for (joint, model) in self.joints.iter_mut().zip(&self.model.axes) {
            joint.settle(model);
        }
    }

    /// Forgets the path, and lets the planner know that its end does not hold any more.
    fn forget_path(&mut self) {
        self.path_generation = self.path_generation.wrapping_add(1);
        self.path.clear();
    }
}
