//! Jobs: loaded, checked, run and resumed.

use super::controller_thread::{ControllerThread, LoadedJob};
use super::job_thread::{JobSource, Prepared, Work};
use super::move_feeder::takes_moves;
use super::parsed_job::ParsedJob;
use super::preview::{JobStart, nearest};
use super::requests::{JOINT_SPEED, Refused};
use super::teaching::NAME;
use super::wire::lease::{Page, PageId};
use super::wire::message::Reading;
use fivebar_files::job::JobOptions;
use fivebar_firmware::{Move, MoveKind};
use fivebar_sim::link::LinkError;
use fivebar_sim::path_queue::way_back;
use std::sync::Arc;

impl ControllerThread {
    pub(super) fn load_job(&mut self, page: PageId, source: JobSource) -> Result<(), Refused> {
        if self.feeder.is_running() {
            return Err("A job is running: stop it first.".into());
        }
        if !self.rests() {
            return Err("The arm is moving: stop it or wait until it rests.".into());
        }
        self.run_asked_by = None;
        self.feeder.forget();
        self.run_on = false;
        let start = self.preview.start(&self.session.status);
        self.jobs.order(Work::Load(page, source), start);
        Ok(())
    }

    /// Places the loaded drawing elsewhere and checks it there.
    pub(super) fn place_job(
        &mut self,
        anew: impl FnOnce(Arc<ParsedJob>) -> Work,
    ) -> Result<(), Refused> {
        if !self.rests() {
            return Err("The arm is moving: stop it or wait until it rests.".into());
        }
        if self.jobs.is_busy() {
            return Err("The job is being checked: wait a moment.".into());
        }
        let loaded = self.loaded.as_ref().ok_or("There is no job: load one.")?;
        let job = Arc::clone(&loaded.job);
        self.feeder.forget();
        let start = self.preview.start(&self.session.status);
        self.jobs.order(anew(job), start);
        Ok(())
    }

    /// Has the loaded file read again, and later ones, in another way.
    pub(super) fn read_again(&mut self, reading: Reading) -> Result<(), Refused> {
        let is_in = |value: Option<f64>, least: f64, most: f64| {
            value.is_none_or(|value| (least..=most).contains(&value))
        };
        if !is_in(reading.hatch, 1e-4, 0.05) {
            return Err("The lines of a hatch must be 0.1 to 50 mm apart.".into());
        }
        if !is_in(reading.speed, 1e-5, 100.0) {
            return Err("The speed must be 0.01 to 100,000 mm/s.".into());
        }
        if !is_in(reading.pen_height, -1.0, 1.0) {
            return Err("The pen's height must be -1000 to 1000 mm.".into());
        }
        if !reading.level.is_none_or(JobOptions::is_level) {
            return Err("The level must be above 0 and below 1.".into());
        }
        if !reading.copies.is_none_or(JobOptions::are_copies) {
            return Err("The columns and rows of copies must be 1 to 100.".into());
        }
        if !is_in(reading.gap, 0.0, 1.0) {
            return Err("The distance between copies must be 0 to 1000 mm.".into());
        }
        if !is_in(reading.margin, 0.0, 1.0) {
            return Err("The margin must be 0 to 1000 mm.".into());
        }
        // The margin changes nothing until the drawing is fitted.
        let with_margin = Reading {
            margin: reading.margin,
            ..self.jobs.reading
        };
        if self.loaded.is_none() || with_margin == reading {
            self.jobs.reading = reading;
            return Ok(());
        }
        let before = std::mem::replace(&mut self.jobs.reading, reading);
        self.place_job(Work::Read)
            .inspect_err(|_| self.jobs.reading = before)
    }

    /// Has the loaded job checked from the tool's present position.
    pub(super) fn check_job_again(&mut self) {
        if let Some(loaded) = &self.loaded {
            let start = self.preview.start(&self.session.status);
            if !self.jobs.is_busy() && loaded.start != start {
                let job = Arc::clone(&loaded.job);
                self.jobs.order(Work::Check(job), start);
            }
        }
    }

    /// Starts the job at this line, if all of it can be done from the tool's present position. A job
    /// that is still read or checked starts afterwards.
    pub(super) fn run_job(&mut self, page: &Page, line: u32) -> Result<(), Refused> {
        self.is_ready()?;
        if self.loaded.is_none() && !self.jobs.is_busy() {
            return Err("There is no job: load one.".into());
        }
        self.check_job_again();
        if self.jobs.is_busy() {
            self.run_asked_by = Some((page.id, line));
            return Ok(());
        }
        self.start_job(page.id, line)
    }

    /// Whether the arm is at rest and takes moves.
    pub(super) fn is_ready(&self) -> Result<(), Refused> {
        if !self.rests() {
            return Err("The arm is moving: stop it or wait until it rests.".into());
        }
        if !takes_moves(self.session.status.state) {
            return Err("The arm is not armed: home it, then arm it.".into());
        }
        Ok(())
    }

    fn start_job(&mut self, page: PageId, line: u32) -> Result<(), Refused> {
        let loaded = self.loaded.as_ref().ok_or("There is no job: load one.")?;
        if let Some(why) = &loaded.refusal {
            return Err(format!("The job cannot be done. {why}"));
        }
        if !takes_moves(self.session.status.state) {
            return Err("The arm is not armed: home it, then arm it.".into());
        }
        let start = self.preview.start(&self.session.status);
        if !self.rests() || loaded.start != start {
            return Err("The arm has moved while its job was checked: run it again.".into());
        }
        let job = Arc::clone(&loaded.job);
        let (index, place) = job
            .at_line(line)
            .ok_or_else(|| format!("The job has no motion at or behind line {line}."))?;
        if let Some(why) = start.behind(&job.outline, line).differs(start) {
            return Err(format!("Line {line} is drawn {why}"));
        }
        let approach = match place.filter(|_| line > 0) {
            Some(place) if self.jobs.is_time_optimal => {
                self.order_rest(page, job, index, place);
                return Ok(());
            }
            Some(place) => self.approach_to(place)?,
            None => None,
        };
        // From its first line on, the job has its own approach.
        let index = if line > 0 { index } else { 0 };
        self.feeder.run(job, index, approach);
        self.notice("The job has started.");
        Ok(())
    }

    /// Goes on with the job at the place where it was stopped.
    pub(super) fn resume_job(&mut self, page: &Page) -> Result<(), Refused> {
        self.is_ready()?;
        let (job, place, seen) = self.feeder.held().ok_or("No job was stopped: run one.")?;
        let now = self.preview.start(&self.session.status);
        if let Some(why) = self.preview.start(seen).differs(now) {
            return Err(format!("The job goes on {why}"));
        }
        if self.jobs.is_time_optimal {
            if self.jobs.is_busy() {
                return Err("The job is being checked: wait a moment.".into());
            }
            let (job, part) = (Arc::clone(job), self.feeder.part().unwrap_or_default());
            self.order_rest(page.id, job, part, place);
            return Ok(());
        }
        let approach = self.approach_to(place)?;
        self.feeder.resume(approach);
        self.notice("The job goes on.");
        Ok(())
    }

    /// Has the rest of a time-optimal job planned; it starts when it is.
    fn order_rest(&mut self, page: PageId, job: Arc<ParsedJob>, part: usize, place: [f32; 2]) {
        let start = self.preview.start(&self.session.status);
        self.jobs.order(Work::Rest(job, part, place), start);
        self.run_asked_by = Some((page, 0));
    }

    /// Starts the rest of a time-optimal job.
    fn start_rest(
        &mut self,
        job: Result<Arc<ParsedJob>, String>,
        start: JobStart,
        place: [f32; 2],
    ) -> Result<(), Refused> {
        self.is_ready()?;
        let job = job.map_err(|why| format!("The rest of the job cannot be done. {why}"))?;
        if self.preview.start(&self.session.status) != start {
            return Err("The arm has moved while its job was planned: ask again.".into());
        }
        let approach = self.approach_to(place)?;
        self.feeder.run(job, 0, approach);
        self.notice("The job goes on.");
        Ok(())
    }

    /// The motion to a place of the job [m] with the tool up: straight, or by the joints if a straight
    /// line would leave the workspace.
    pub(super) fn approach_to(&self, place: [f32; 2]) -> Result<Option<MoveKind>, Refused> {
        let start = self.preview.start(&self.session.status);
        let (Some(from), Some(branch)) = (self.session.status.reference, start.branch) else {
            return Err("The arm is not armed: home it, then arm it.".into());
        };
        let Some(line) = way_back(from, place, self.session.settings.motion.max_speed) else {
            return Ok(None);
        };
        let planner = self.preview.planner(start).map_err(|e| e.to_string())?;
        let [now1, now4] = self.session.status.angle;
        let by_joints = self.preview.joints(place, branch).map(|[to1, to4]| {
            let to = [nearest(to1, now1), nearest(to4, now4)];
            let speed = JOINT_SPEED;
            MoveKind::Joint { to, speed }
        });
        let (tag, tool) = (0, 0);
        let candidates = [Some(line), by_joints].into_iter().flatten();
        let mut candidates =
            candidates.filter(|&kind| planner.check(from, &Move { tag, tool, kind }).is_ok());
        candidates
            .next()
            .map(Some)
            .ok_or_else(|| "No motion leads to the job's place: move the tool nearer to it.".into())
    }

    /// Goes on with an arm that a hand leads; what was taught becomes the job.
    pub(super) fn be_led(&mut self) -> Result<(), LinkError> {
        let page_is_alive = self.may_feed()?;
        let Some(mut teaching) = self.teaching.take() else {
            return Ok(());
        };
        let is_over = teaching.go_on(&mut self.session, page_is_alive)?;
        let status = self.session.status;
        self.note_position(&status);
        if !is_over {
            self.teaching = Some(teaching);
            return Ok(());
        }
        let loaded = match teaching.path(&self.tool) {
            Ok(path) => {
                let (time, length) = (path.time(), 1e3 * path.length());
                self.notice(&format!(
                    "{time:.1} s and {length:.0} mm were taught, and are the job now."
                ));
                let source = JobSource::InPlace(NAME.into(), path.to_gcode());
                self.load_job(teaching.page, source)
            }
            Err(why) => Err(format!("Nothing was taught: {why}.")),
        };
        if let Err(why) = loaded {
            self.refuse(Some(teaching.page), why);
        }
        Ok(())
    }

    /// Takes a job that was read and checked, and starts it if its page has asked for that.
    pub(super) fn take_prepared_job(&mut self) {
        let Some(prepared) = self.jobs.take() else {
            return;
        };
        let asked_by = self.run_asked_by.take();
        let (start, again) = match prepared {
            Prepared::Times { job, message } => {
                self.run_asked_by = asked_by;
                self.feeder.set_times(&job);
                if let Some(loaded) = &mut self.loaded {
                    loaded.job = job;
                    self.updates.send_job(message);
                }
                return;
            }
            Prepared::Job {
                job,
                start,
                refusal,
                drawn_box,
                message,
                again,
            } => {
                self.loaded = Some(LoadedJob {
                    job,
                    start,
                    refusal,
                    drawn_box,
                });
                self.updates.send_job(message);
                (start, again)
            }
            Prepared::Rest { job, start, place } => {
                let Some((page, _)) = asked_by.filter(|&(page, _)| self.has_control(page)) else {
                    return;
                };
                if let Err(why) = self.start_rest(job, start, place) {
                    self.refuse(Some(page), why);
                }
                return;
            }
            Prepared::Macro(read) => {
                if asked_by.is_none() {
                    self.start_macro(read);
                }
                self.go_on_with_job(asked_by);
                return;
            }
            Prepared::Line(to, found) => {
                self.tell_line(to, found);
                self.go_on_with_job(asked_by);
                return;
            }
            Prepared::Unreadable(message) => {
                self.loaded = None;
                self.updates.send_job(message);
                return;
            }
            Prepared::NoJob(page, why) => {
                self.refuse(
                    Some(page),
                    format!("The server does not know this request; load the page again ({why})."),
                );
                return;
            }
        };
        // The arm may have been homed or moved while the job was read.
        if !again && (asked_by.is_some() || !start.is_known()) {
            self.check_job_again();
        }
        let Some((page, line)) = asked_by else {
            return;
        };
        if self.jobs.is_busy() {
            self.run_asked_by = asked_by;
            return;
        }
        if self.has_control(page)
            && let Err(why) = self.start_job(page, line)
        {
            self.refuse(Some(page), why);
        }
    }

    /// Has the loaded job checked and timed behind other work, if its times are not planned yet or a page waits for it.
    fn go_on_with_job(&mut self, asked_by: Option<(PageId, u32)>) {
        self.run_asked_by = asked_by;
        if let Some(loaded) = &self.loaded
            && (asked_by.is_some() || !loaded.job.is_timed)
        {
            let job = Arc::clone(&loaded.job);
            let start = self.preview.start(&self.session.status);
            self.jobs.order(Work::Check(job), start);
        }
    }

    pub(super) fn has_control(&self, page: PageId) -> bool {
        let lease = &self.pages.shared.lease;
        lease.is_held_by(page, self.session.clock.now())
    }
}
