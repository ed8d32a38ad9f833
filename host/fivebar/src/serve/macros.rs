//! The macros of the robot file: a few lines of G-code by a button, checked as a job before the arm moves.

use super::controller_thread::ControllerThread;
use super::job_thread::Work;
use super::preview::JobStart;
use super::requests::Refused;
use super::wire::lease::{Page, PageId};
use fivebar_firmware::Move;

/// A macro that was read and checked.
pub(super) struct ReadMacro {
    /// The page that asked for it.
    pub(super) page: PageId,
    pub(super) name: String,
    /// Where it was checked from.
    pub(super) start: JobStart,
    /// Its moves, or why it cannot be done.
    pub(super) moves: Result<Vec<Move>, Refused>,
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
