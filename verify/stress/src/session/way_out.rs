//! The way out of the state in which a session ends.

use super::{POLL, Session};
use crate::arm::plant;
use crate::rules::Violation;
use crate::way_out::{Machine, WayOut, way_out};
use fivebar_firmware::Status;
use fivebar_firmware::protocol::{CommandError, HostCommand};
use fivebar_kinematics::five_bar::Joint;

impl Session<'_> {
    /// Lets nothing disturb the arm any more, and tries the way out of the state.
    pub(super) fn find_way_out(&mut self) -> Result<(), Violation> {
        (self.hostile, self.corrupt, self.planner_every) = (None, None, 1);
        if !self.is_sound {
            self.plant = plant(self.flags);
        }
        // The counts of another arm are a jump.
        self.wait(2, true)?;
        let out = way_out(self)?;
        self.report.ways_out[usize::from(out != WayOut::Motion)] += 1;
        Ok(())
    }
}

impl Machine for Session<'_> {
    fn send(&mut self, command: HostCommand) -> Result<Option<CommandError>, Violation> {
        // A hello begins the count anew, whatever frames were lost or skipped.
        self.command(command)?;
        Ok(self.refused)
    }

    fn pass(&mut self, ticks: u32) -> Result<(), Violation> {
        let begun = self.report.ticks;
        for _ in 0..ticks {
            if (self.report.ticks - begun) % POLL == POLL - 1 {
                self.command(HostCommand::Status)?;
            }
            self.tick()?;
        }
        Ok(())
    }

    fn status(&self) -> Status {
        self.controller.status()
    }

    fn angles(&self) -> [f32; 2] {
        Joint::ALL.map(|joint| self.plant.angle(joint) as f32)
    }
}
