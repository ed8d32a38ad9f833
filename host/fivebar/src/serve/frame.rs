//! A tour around a drawing with the pen up: it shows where on the paper the drawing will lie.

use super::controller_thread::ControllerThread;
use super::packed::Shelved;
use super::parsed_job::{ParsedJob, Size};
use super::requests::Refused;
use fivebar_files::job::Job;
use fivebar_firmware::{Move, MoveKind};
use std::sync::Arc;

impl ControllerThread {
    /// Moves the tool, lifted, along the rectangle around what the loaded job draws. All of it is checked before the arm
    /// moves.
    pub(super) fn go_around(&mut self) -> Result<(), Refused> {
        self.is_ready()?;
        let loaded = self.loaded.as_ref().ok_or("There is no job: load one.")?;
        let [[left, low], [right, high]] = loaded.drawn_box.ok_or("The job draws nothing.")?;
        let name = format!("around {}", loaded.job.name);
        let first = [left, low];
        let corners = [[right, low], [right, high], [left, high], first];
        let feed = self.session.settings.motion.max_speed;
        let start = self.preview.start(&self.session.status);
        let planner = self.preview.planner(start).map_err(|e| e.to_string())?;
        let (mut from, mut moves) = (first, Vec::new());
        for to in corners {
            // A drawing that is one straight line has sides without length.
            if to == from {
                continue;
            }
            let (tag, tool, kind) = (0, 0, MoveKind::Line { to, feed });
            let side = Move { tag, tool, kind };
            if planner.check(from, &side).is_err() {
                let [x, y] = to.map(|coordinate| 1e3 * coordinate);
                return Err(format!(
                    "The tool cannot go straight to the corner at ({x:.1}, {y:.1}) mm: the rectangle around the drawing \
                     leaves where the arm can move. Make the drawing smaller, or move it."
                ));
            }
            moves.push(side);
            from = to;
        }
        let approach = self.approach_to(first)?;
        let no_text = Arc::new(Shelved::of(&String::new()));
        let around = ParsedJob::new(name, no_text, (Job::default(), Size::TRUE), &moves);
        self.feeder.run(Arc::new(around), 0, approach);
        self.notice("The lifted tool goes around the drawing.");
        Ok(())
    }
}
