//! The macros of the robot file: a few lines of G-code by a button, checked as a job before the arm moves.

use super::controller_thread::ControllerThread;
use super::job_thread::{ReadMacro, Work, Workshop, sentence};
use super::preview::JobStart;
use super::requests::Refused;
use super::wire::lease::{Page, PageId};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::Move;

impl Workshop {
    /// Reads a macro and checks it.
    pub(super) fn read_macro(&self, page: PageId, name: String, start: JobStart) -> ReadMacro {
        ReadMacro {
            moves: self.macro_moves(&name, start),
            page,
            name,
            start,
        }
    }

    /// The moves of a macro, all of which the arm can do from where it is.
    fn macro_moves(&self, name: &str, start: JobStart) -> Result<Vec<Move>, String> {
        let unknown = || "The robot file has no such macro.".to_owned();
        let text = self.robot.macros.get(name).ok_or_else(unknown)?;
        // X0 Y0 is where it is for senders.
        let home = self.robot.home_pose().map_err(sentence)?;
        let scenario = Scenario {
            origin: Some(self.robot.tool_at(&home)),
            reader: self.reader,
            ..Scenario::new(name, self.robot.clone(), "macro.gcode", text.clone())
        };
        let job = scenario.job().map_err(sentence)?;
        let moves = self.moves(name, &job, start)?;
        let message = self.preview.job(name, &job, &moves, start);
        message.refusal.map_or(Ok(moves), Err)
    }
}

impl ControllerThread {
    /// Has a macro read and checked; the arm does it then.
    pub(super) fn do_macro(&mut self, page: &Page, name: &str) -> Result<(), Refused> {
        self.is_ready()?;
        if self.jobs.is_busy() {
            return Err("The job is being checked: wait a moment.".into());
        }
        let start = self.preview.start(&self.session.status);
        self.jobs.order(Work::Macro(page.id, name.into()), start);
        Ok(())
    }

    /// Does a macro that was read, where the arm has not moved since.
    pub(super) fn start_macro(&mut self, read: ReadMacro) {
        let ReadMacro {
            page,
            name,
            start,
            moves,
        } = read;
        if !self.has_control(page) {
            return;
        }
        let outcome = self.is_ready().and(moves).and_then(|moves| {
            let has_moved = self.preview.start(&self.session.status) != start;
            let moves = moves.into_iter().map(|next| Move { tag: 0, ..next });
            if has_moved || !self.feeder.has_no_target() {
                return Err("The arm has moved meanwhile: ask again.".into());
            }
            self.feeder.set_moves(moves);
            Ok(())
        });
        if let Err(why) = outcome {
            self.refuse(Some(page), format!("{name}: {why}"));
        }
    }
}
