//! The thread that reads and checks jobs, so that the controller's thread waits for none.

use super::lease::PageId;
use super::message::{ClientRequest, JobMessage, ServerMessage, Shift, brief};
use super::preview::{JobStart, Preview};
use crate::input::job::{Job, Placement};
use crate::input::robot::Robot;
use crate::input::scenario::Scenario;
use crate::show::path_queue::{divided, duration, end};
use fivebar_firmware::Move;
use std::sync::{Arc, Condvar, Mutex, PoisonError, mpsc};
use std::thread;
use tokio_tungstenite::tungstenite::Utf8Bytes;

/// A job that was read.
pub(super) struct ParsedJob {
    name: String,
    job: Job,
    moves: Vec<Move>,
    /// The moves in pieces short enough for a new share of the feed rate to take effect soon.
    pub(super) pieces: Vec<Move>,
    /// The time from the start to the end of each piece, at its feed rate [s].
    pub(super) times: Vec<f64>,
}

impl ParsedJob {
    fn new(name: String, job: Job, moves: Vec<Move>) -> Self {
        let pieces = divided(None, &moves);
        let (mut place, mut time) = (None, 0.0);
        let times = pieces.iter().map(|next| {
            time += duration(place, next);
            place = end(next).or(place);
            time
        });
        Self {
            times: times.collect(),
            pieces,
            name,
            job,
            moves,
        }
    }
}

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
    /// Place a job elsewhere and check it.
    Place(Arc<ParsedJob>, Shift),
    /// Check a job again, because the arm has moved.
    Check(Arc<ParsedJob>),
}

/// A job as a page sent it.
pub(super) enum JobSource {
    /// Its name and its G-code.
    Text(String, String),
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
        /// The message to the pages.
        message: Utf8Bytes,
        /// Whether the job was read earlier and only checked now.
        again: bool,
    },
    /// The job cannot be read; this tells the pages why.
    Unreadable(Utf8Bytes),
    /// The page's message is no job, for this reason.
    NoJob(PageId, String),
}

/// Work, its number, and where a job would begin.
type Order = (u64, Work, JobStart);

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
}

impl JobThread {
    pub(super) fn start(robot: Robot, preview: Preview) -> Self {
        let place = Arc::new(Place::default());
        let (sender, results) = mpsc::channel();
        let orders = Arc::clone(&place);
        thread::spawn(move || {
            while let Some((number, work, start)) = orders.wait() {
                let prepared = prepare(&robot, &preview, work, start);
                if sender.send((number, prepared)).is_err() {
                    return;
                }
            }
        });
        Self {
            place,
            results,
            last: 0,
            busy: false,
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
            place.0.replace((self.last, work, start))
        };
        drop(replaced);
        self.place.changed.notify_one();
    }

    /// The result of the last order, once it is done.
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

fn prepare(robot: &Robot, preview: &Preview, work: Work, start: JobStart) -> Prepared {
    let again = matches!(work, Work::Check(_));
    let job = match work {
        Work::Check(job) => job,
        Work::Place(job, shift) => {
            let moved = job.job.moved(&shift.placement());
            let scenario = Scenario::new(&job.name, robot.clone(), &job.name, String::new());
            let moves = scenario.moves(&moved);
            Arc::new(ParsedJob::new(job.name.clone(), moved, moves))
        }
        Work::Load(page, source) => {
            let (name, text) = match source {
                JobSource::Text(name, text) => (name, text),
                JobSource::Message(message) => match serde_json::from_str(&message) {
                    Ok(ClientRequest::Load { name, text }) => (name, text),
                    Ok(_) => return Prepared::NoJob(page, "it is too long".into()),
                    Err(error) => return Prepared::NoJob(page, brief(error.to_string())),
                },
            };
            let name = brief(name);
            let scenario = Scenario::new(&name, robot.clone(), &name, text);
            match scenario.job() {
                Ok(job) => {
                    let moves = scenario.moves(&job);
                    Arc::new(ParsedJob::new(name, job, moves))
                }
                Err(error) => {
                    let refusal = Some(brief(error.to_string()));
                    let message = JobMessage {
                        name,
                        refusal,
                        ..JobMessage::default()
                    };
                    return Prepared::Unreadable(ServerMessage::Job(&message).json());
                }
            }
        }
    };
    let message = preview.job(&job.name, &job.job, &job.moves, start);
    Prepared::Job {
        message: ServerMessage::Job(&message).json(),
        refusal: message.refusal,
        job,
        start,
        again,
    }
}
