//! What the stops do that pages ask for.

use super::controller_thread::ControllerThread;
use super::move_feeder::JobStatus;
use super::wire::lease::PageId;
use super::wire::message::ServerMessage;
use super::wire::stop_signal::Stop;
use fivebar_firmware::Request;
use fivebar_firmware::safety::State;
use fivebar_sim::link::LinkError;

impl ControllerThread {
    /// Does the stops that pages have asked for, and that of a motion that is held no more; returns whether there was
    /// one.
    pub(super) fn stop_if_asked(&mut self) -> Result<bool, LinkError> {
        let mut asked = self.stop_held_motion()?;
        for _ in 0..Stop::KINDS {
            let Some((stop, page)) = self.pages.shared.stop.take() else {
                break;
            };
            asked = true;
            match stop {
                Stop::Emergency => self.emergency_stop()?,
                Stop::OnPath => self.stop_on_path(page)?,
            }
        }
        Ok(asked)
    }

    /// Has the controller latch the emergency stop, whatever it does and whoever is in control, and
    /// confirms it to the pages. They ask again until it is confirmed.
    fn emergency_stop(&mut self) -> Result<(), LinkError> {
        let refusal = self.session.request(Request::EmergencyStop)?.err();
        if self.senders.is_in_control() {
            self.senders.emergency_stop(&mut self.session)?;
        } else {
            self.drop_what_pages_asked_for();
        }
        let (status, _) = self.session.client.status()?;
        match refusal {
            Some(refusal) => self.refuse(None, refusal),
            None if status.fault.is_none() => self.refuse(None, "No fault is latched.".into()),
            None => self.updates.send(&ServerMessage::Stopped(Stop::Emergency)),
        }
        Ok(())
    }

    pub(super) fn stop_on_path(&mut self, page: PageId) -> Result<(), LinkError> {
        // A console that waits for its next line is not held: it would answer no more.
        let is_idle = self.senders.is_console_idle(&self.session);
        if self.senders.is_in_control() && !is_idle {
            return self.senders.hold(&mut self.session);
        }
        self.drop_what_pages_asked_for();
        match self.session.request(Request::Stop)? {
            Ok(()) => self.updates.send(&ServerMessage::Stopped(Stop::OnPath)),
            Err(refusal) => self.refuse(Some(page), refusal),
        }
        Ok(())
    }

    /// Drops the target and what waits to be moved to. A job keeps its place.
    fn drop_what_pages_asked_for(&mut self) {
        let was_running = self.feeder.is_running();
        self.feeder.stop();
        if was_running {
            self.report_job(JobStatus::Held);
        }
        self.run_asked_by = None;
        self.mode_wanted = None;
        self.held_by = None;
    }

    /// Whether the arm rests, with bridges on or off.
    pub(super) fn rests(&self) -> bool {
        use State::{
            Armed, Compliant, Crossing, Exciting, Fault, Homing, Running, Stopped, Stopping,
        };
        match self.session.status.state {
            Stopped | Armed | Fault => true,
            Homing | Running | Stopping | Exciting | Crossing | Compliant => false,
        }
    }
}

#[cfg(test)]
mod tests;
