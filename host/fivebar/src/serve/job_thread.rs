//! The thread that reads and checks jobs, so that the controller's thread waits for none.

use super::packed::Shelved;
use super::parsed_job::{ParsedJob, Size};
use super::preview::{Branch, JobStart, Preview};
use super::strokes::drawn_box;
use super::wire::lease::PageId;
use super::wire::message::{ClientRequest, JobMessage, Reading, ServerMessage, Shift, brief};
use super::wire::numbered::NumberedRequest;
use fivebar_files::job::{Job, JobOptions, JobReader, Placement};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::{Kept, Scenario, middle};
use fivebar_firmware::Move;
use fivebar_sim::time_optimal::JobPlanner;
use std::sync::{Arc, Condvar, Mutex, PoisonError, mpsc};
use std::thread;
use tokio_tungstenite::tungstenite::Utf8Bytes;

impl Shift {
    /// The same as a placement of the drawing as it is. A drawing becomes neither a point nor
    /// larger than any arm.
    fn placement(&self) -> Placement {
        let centred = Placement {
            origin: [0.0; 2],
            scale: self.scale.clamp(1e-3, 1e3),
            turn: self.turn,
            home: [0.0; 2],
        };
        let [x, y] = centred.place(self.about);
        let [about, by] = [self.about, self.by];
        Placement {
            origin: [about[0] + by[0] - x, about[1] + by[1] - y],
            ..centred
        }
    }
}

/// What the thread is to do.
pub(super) enum Work {
    /// Read a job and check it.
    Load(PageId, JobSource),
    /// Read the file of a job again, at the same place, and check it.
    Read(Arc<ParsedJob>),
    /// Place a job elsewhere and check it.
    Place(Arc<ParsedJob>, Shift),
    /// Place a job where the arm can draw it largest, and check it.
    Fit(Arc<ParsedJob>),
    /// Check a job again, because the arm has moved.
    Check(Arc<ParsedJob>),
    /// Read a macro of the robot file, and check it.
    Macro(PageId, String),
    /// Look for the line of a job that draws nearest to this point [m].
    LineAt(PageId, Arc<ParsedJob>, [f32; 2]),
    /// Plan the rest of a time-optimal job from this place [m] on one of its parts on.
    Rest(Arc<ParsedJob>, usize, [f32; 2]),
}

/// A job as a page sent it, or as a hand taught it.
pub(super) enum JobSource {
    /// Its name and its G-code.
    Text(String, String),
    /// The same in the frame of the base, to be drawn there.
    InPlace(String, String),
    /// A message that was too long to be read where it arrived.
    Message(Utf8Bytes),
}

/// The result of the thread's work.
pub(super) enum Prepared {
    /// A job that was read and checked.
    Job {
        job: Arc<ParsedJob>,
        /// Where it was checked from.
        start: JobStart,
        /// Why it cannot be done from there.
        refusal: Option<String>,
        /// The corners of what it draws, as in a `LoadedJob`.
        drawn_box: Option<[[f32; 2]; 2]>,
        /// The message to the pages.
        message: Utf8Bytes,
        /// Whether the job was read earlier and only checked now.
        again: bool,
    },
    /// The rest of a time-optimal job.
    Rest {
        job: Result<Arc<ParsedJob>, String>,
        /// Where the arm was when it was asked for.
        start: JobStart,
        /// Where the rest begins [m].
        place: [f32; 2],
    },
    /// A macro.
    Macro(ReadMacro),
    /// A page's line of the job, and where the tool is before it [m]; none if the job draws nothing.
    Line(PageId, Option<(u32, [f32; 2])>),
    /// The times of a job that was prepared before.
    Times {
        /// The job with its times.
        job: Arc<ParsedJob>,
        /// The message to the pages.
        message: Utf8Bytes,
    },
    /// The job cannot be read; this is the message to the pages that says why.
    Unreadable(Utf8Bytes),
    /// The page's message is no job, for this reason.
    NoJob(PageId, String),
}

/// A macro that was read and checked.
pub(super) struct ReadMacro {
    /// The page that asked for it.
    pub(super) page: PageId,
    pub(super) name: String,
    /// Where it was checked from.
    pub(super) start: JobStart,
    /// Its moves, or why it cannot be done.
    pub(super) moves: Result<Vec<Move>, String>,
}

/// A job that can be done, and its message to the pages.
type Untimed = (Arc<ParsedJob>, JobMessage);

/// Work, its number, where a job would begin, and how its file is read.
type Order = (u64, Work, JobStart, Reading);

/// The thread's one place for work: a later order replaces one that has not begun.
#[derive(Default)]
struct Place {
    order: Mutex<(Option<Order>, bool)>,
    changed: Condvar,
}

/// The thread, seen from the controller's.
pub(super) struct JobThread {
    place: Arc<Place>,
    results: mpsc::Receiver<(u64, Prepared)>,
    /// The number of the last order.
    last: u64,
    busy: bool,
    /// How files are read.
    pub(super) reading: Reading,
    /// Whether jobs run as time-optimal motions.
    pub(super) is_time_optimal: bool,
}

/// What the thread prepares jobs with.
pub(super) struct Workshop {
    pub(super) robot: Robot,
    pub(super) preview: Preview,
    pub(super) reader: JobReader,
    /// The planner of time-optimal motion; none: the controller plans.
    planner: Option<JobPlanner>,
    /// How files are read.
    reading: Reading,
}

impl JobThread {
    pub(super) fn start(
        robot: Robot,
        preview: Preview,
        reader: JobReader,
        planner: Option<JobPlanner>,
    ) -> Self {
        let is_time_optimal = planner.is_some();
        let mut workshop = Workshop {
            robot,
            preview,
            reader,
            planner,
            reading: Reading::default(),
        };
        let place = Arc::new(Place::default());
        let (sender, results) = mpsc::channel();
        let orders = Arc::clone(&place);
        thread::spawn(move || {
            while let Some((number, work, start, reading)) = orders.wait() {
                workshop.reading = reading;
                let (prepared, untimed) = workshop.prepare(work, start);
                if sender.send((number, prepared)).is_err() {
                    return;
                }
                // Pages show a long job before its time is known.
                let times = untimed.and_then(|untimed| {
                    let goes_on = || orders.is_empty();
                    workshop.times(untimed, start, &goes_on)
                });
                if let Some(times) = times
                    && sender.send((number, times)).is_err()
                {
                    return;
                }
            }
        });
        Self {
            place,
            results,
            last: 0,
            busy: false,
            reading: Reading::default(),
            is_time_optimal,
        }
    }

    /// Whether an order waits or is being done.
    pub(super) fn is_busy(&self) -> bool {
        self.busy
    }

    /// Gives an order. The results of earlier ones are dropped.
    pub(super) fn order(&mut self, work: Work, start: JobStart) {
        self.last += 1;
        self.busy = true;
        let replaced = {
            let mut place = self.place.lock();
            place.0.replace((self.last, work, start, self.reading))
        };
        drop(replaced);
        self.place.changed.notify_one();
    }

    /// The result of the last order, once it is done, and later its job's times.
    pub(super) fn take(&mut self) -> Option<Prepared> {
        loop {
            let (number, prepared) = self.results.try_recv().ok()?;
            if number == self.last {
                self.busy = false;
                return Some(prepared);
            }
        }
    }
}

impl Drop for JobThread {
    fn drop(&mut self) {
        *self.place.lock() = (None, true);
        self.place.changed.notify_one();
    }
}

impl Place {
    fn lock(&self) -> std::sync::MutexGuard<'_, (Option<Order>, bool)> {
        self.order.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether no order waits, and the controller's thread goes on.
    fn is_empty(&self) -> bool {
        matches!(*self.lock(), (None, false))
    }

    /// The next order; none when the controller's thread has ended.
    fn wait(&self) -> Option<Order> {
        let mut place = self.lock();
        loop {
            if place.1 {
                return None;
            }
            if let Some(order) = place.0.take() {
                return Some(order);
            }
            place = self
                .changed
                .wait(place)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }
}

impl Workshop {
    /// The result of the work, and the job whose times are still to be planned.
    fn prepare(&self, work: Work, start: JobStart) -> (Prepared, Option<Untimed>) {
        let again = matches!(work, Work::Check(_));
        let mut refusal = None;
        let mut parsed = |old: &Arc<ParsedJob>, job: Result<(Job, Size), String>| {
            let parsed = |job| self.parsed(&old.name, Arc::clone(&old.text), job, start);
            match job.and_then(parsed) {
                Ok(job) => Arc::new(job),
                Err(why) => {
                    refusal = Some(brief(why));
                    Arc::clone(old)
                }
            }
        };
        let job = match work {
            // The moves of a change of the working mode depend on where the arm is.
            Work::Check(job) if job.outline.first_change_of_mode().is_some() => {
                parsed(&job, Ok((job.job.value(), job.size)))
            }
            Work::Check(job) => job,
            Work::Place(job, shift) => {
                let placement = shift.placement();
                let size = Size {
                    scale: job.size.scale * placement.scale,
                    turn: job.size.turn + placement.turn,
                };
                parsed(&job, Ok((job.job.value().moved(&placement), size)))
            }
            Work::Read(job) => parsed(&job, self.read_again(&job)),
            Work::Fit(job) => parsed(&job, self.fitted(&job)),
            Work::Rest(job, part, place) => {
                return (self.rest(&job, part, place, start), None);
            }
            Work::Macro(page, name) => {
                return (Prepared::Macro(self.read_macro(page, name, start)), None);
            }
            Work::LineAt(page, job, point) => {
                return (Prepared::Line(page, job.line_at(point)), None);
            }
            Work::Load(page, source) => match self.load(page, source, start) {
                Ok(job) => Arc::new(job),
                Err(unreadable) => return (unreadable, None),
            },
        };
        let from = self.or_home(start);
        let mut message = self
            .preview
            .job(&job.name, &job.outline, &job.moves.unpacked(), from);
        message.is_from_home = !start.is_known() && from.is_known();
        message.refusal = message.refusal.or(refusal);
        message.layers = job.layers();
        message.scale = job.size.scale;
        message.turn = job.size.turn;
        message.reading = self.reading;
        let job = match &self.planner {
            Some(planner) if message.refusal.is_none() => {
                match job.planned(planner, &self.preview, from) {
                    Ok(planned) => Arc::new(planned),
                    Err(why) => {
                        message.refusal = Some(brief(why));
                        job
                    }
                }
            }
            _ => job,
        };
        let prepared = Prepared::Job {
            message: ServerMessage::Job(&message).json(),
            refusal: message.refusal.clone(),
            drawn_box: drawn_box(&message.strokes),
            job: Arc::clone(&job),
            start,
            again,
        };
        let untimed = message.refusal.is_none().then_some((job, message));
        (prepared, untimed)
    }

    /// The rest of a time-optimal job.
    fn rest(&self, job: &ParsedJob, part: usize, place: [f32; 2], start: JobStart) -> Prepared {
        let from = start.at(place);
        let rest = job.rest(part, place);
        let planned = self.planner.as_ref().map_or_else(
            || Err("The server plans no motion.".into()),
            |planner| rest.planned(planner, &self.preview, from),
        );
        let timed = |job: ParsedJob| job.timed(&self.preview, from, &|| true).unwrap_or(job);
        Prepared::Rest {
            job: planned.map(|job| Arc::new(timed(job))),
            start,
            place,
        }
    }

    /// The times of a job, planned while `goes_on` returns true.
    fn times(
        &self,
        (job, mut message): Untimed,
        start: JobStart,
        goes_on: &dyn Fn() -> bool,
    ) -> Option<Prepared> {
        let job = job.timed(&self.preview, self.or_home(start), goes_on)?;
        message.time = job.time();
        Some(Prepared::Times {
            job: Arc::new(job),
            message: ServerMessage::Job(&message).json(),
        })
    }

    /// Where a job begins: an arm whose position is unknown is at home once it is homed.
    fn or_home(&self, start: JobStart) -> JobStart {
        let home = || {
            let assembly = self.robot.home_pose().ok()?.assembly();
            let mode = self.robot.working_mode();
            let elbows = [mode.elbow1, mode.elbow4];
            // `as` rounds.
            let angles = self.robot.home.map(|angle| angle as f32);
            let tool = self.preview.tool_at(angles, assembly)?;
            Some(JobStart::on(Branch { elbows, assembly }).at(tool))
        };
        match start.is_known() {
            true => start,
            false => home().unwrap_or(start),
        }
    }

    /// The drawing of a job's file at the greatest scale for this arm, turned and placed for it.
    fn fitted(&self, job: &ParsedJob) -> Result<(Job, Size), String> {
        let mut scenario = self.scenario(&job.name, job.text.value());
        let kept = Kept {
            scale: false,
            turn: false,
        };
        scenario.fit_to_reach(kept).map_err(sentence)?;
        let size = Size {
            scale: scenario.scale,
            turn: scenario.turn,
        };
        Ok((scenario.job().map_err(sentence)?, size))
    }

    /// The drawing of a job's file, read anew, with the size, the turn and the middle that it has now.
    fn read_again(&self, job: &ParsedJob) -> Result<(Job, Size), String> {
        let scenario = Scenario {
            origin: Some([0.0; 2]),
            scale: job.size.scale,
            turn: job.size.turn,
            ..self.scenario(&job.name, job.text.value())
        };
        let read = scenario.job().map_err(sentence)?;
        let (now, before) = (middle(&read), middle(&job.job.value()));
        let placement = Placement {
            origin: [before[0] - now[0], before[1] - now[1]],
            scale: 1.0,
            turn: 0.0,
            home: [0.0; 2],
        };
        Ok((read.moved(&placement), job.size))
    }

    fn scenario(&self, name: &str, text: String) -> Scenario {
        let Reading {
            hatch,
            speed,
            pen_height,
            trace,
            level,
            copies,
            gap,
            margin,
        } = self.reading;
        let default = JobOptions::default();
        let options = JobOptions {
            hatch,
            speed,
            pen_height,
            trace,
            level,
            copies: copies.unwrap_or(default.copies),
            gap: gap.unwrap_or(default.gap),
            ..default
        };
        Scenario {
            margin: margin.unwrap_or_default(),
            options,
            reader: self.reader,
            ..Scenario::new(name, self.robot.clone(), name, text)
        }
    }

    /// Reads a job; or else what the pages get to know.
    fn load(
        &self,
        page: PageId,
        source: JobSource,
        start: JobStart,
    ) -> Result<ParsedJob, Prepared> {
        let mut origin = None;
        let (name, text) = match source {
            JobSource::Text(name, text) => (name, text),
            JobSource::InPlace(name, text) => {
                origin = Some([0.0; 2]);
                (name, text)
            }
            JobSource::Message(message) => match serde_json::from_str(&message) {
                Ok(NumberedRequest {
                    request: ClientRequest::Load { name, text },
                    ..
                }) => (name, text),
                Ok(_) => return Err(Prepared::NoJob(page, "it is too long".into())),
                Err(error) => return Err(Prepared::NoJob(page, brief(error.to_string()))),
            },
        };
        let name = brief(name);
        let shelved = Arc::new(Shelved::of(&text));
        let scenario = Scenario {
            origin,
            ..self.scenario(&name, text)
        };
        let job = scenario.job();
        drop(scenario);
        match job {
            Ok(job) => {
                let parsed = self.parsed(&name, shelved, (job, Size::TRUE), start);
                parsed.map_err(|why| unreadable(name, why, self.reading))
            }
            Err(error) => Err(unreadable(name, error.to_string(), self.reading)),
        }
    }

    fn parsed(
        &self,
        name: &str,
        text: Arc<Shelved<String>>,
        (job, size): (Job, Size),
        start: JobStart,
    ) -> Result<ParsedJob, String> {
        let moves = self.moves(name, &job, start)?;
        Ok(ParsedJob::new(name.into(), text, (job, size), &moves))
    }

    /// The moves of a job that was read, for the arm where it is; why it has none.
    pub(super) fn moves(
        &self,
        name: &str,
        job: &Job,
        start: JobStart,
    ) -> Result<Vec<Move>, String> {
        let scenario = self.scenario(name, String::new());
        let mode = start.branch.map(|branch| branch.mode());
        let mode = mode.unwrap_or_else(|| self.robot.working_mode());
        let assembly = start.branch.map(|branch| branch.assembly);
        scenario.moves_in(mode, assembly, job).map_err(sentence)
    }
}

/// What an error says, as a sentence.
pub(super) fn sentence(error: impl std::fmt::Display) -> String {
    let mut sentence = format!("{error}.");
    if let Some(first) = sentence.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    sentence
}

fn unreadable(name: String, why: String, reading: Reading) -> Prepared {
    let message = JobMessage {
        name,
        reading,
        refusal: Some(brief(why)),
        ..JobMessage::default()
    };
    Prepared::Unreadable(ServerMessage::Job(&message).json())
}
