//! The thread that speaks with the controller.

use super::Pace;
use super::shared::{Busy, Shared};
use crate::controller::{Connection, Session};
use crate::drive::{Controlled, Drive, DriveError, Given, Homing};
use crate::link::{Client, LinkError};
use crate::streaming::StreamOptions;
use crate::teaching::Record;
use fivebar_files::job::Pause;
use fivebar_firmware::protocol::StreamState;
use fivebar_firmware::{Move, Request, Status};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender, TryRecvError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Rounds of 10 ms before the first call: drives on a bus answer some time after their power.
const WAKING: u32 = 20;

/// Time between two looks for a stop while an arm whose time stands still waits for a point.
const LOOK: Duration = Duration::from_millis(10);

/// Time in which a program gives its next point after one was taken. Several are due in a round of 10 ms at high rates.
const NEXT: Duration = Duration::from_millis(2);

/// What is to be done.
pub(super) enum Task {
    Home(Homing),
    MotorsOn,
    MotorsOff,
    ClearFault,
    /// Moves that are checked; with `power`, motors that are off are on meanwhile.
    Follow {
        moves: Vec<Move>,
        pauses: Vec<Pause>,
        power: bool,
    },
    /// A hand leads the arm for so long [s].
    BeLed {
        seconds: f64,
        record: Arc<Mutex<Record>>,
    },
    /// Set-points as the program gives them.
    Stream {
        options: StreamOptions,
        given: Receiver<Given>,
    },
}

/// How a call ends.
pub(super) type Outcome = Result<(), DriveError>;

/// What the thread is sent.
pub(super) enum Order {
    /// A call: it answers when it is done.
    Call {
        task: Box<Task>,
        busy: Busy,
        answer: Sender<Outcome>,
    },
    /// Look whether an emergency stop is asked for.
    Look,
}

impl Order {
    /// The task of a call, and its answer.
    pub(super) fn new(task: Task, busy: Busy) -> (Self, Receiver<Outcome>) {
        let (answer, waits) = mpsc::channel();
        let task = Box::new(task);
        (Self::Call { task, busy, answer }, waits)
    }
}

/// Starts the thread. It ends with its orders: the arm is then at rest and its motors are off.
pub(super) fn spawn(
    session: Session,
    orders: Receiver<Order>,
    shared: Arc<Shared>,
    pace: Pace,
) -> JoinHandle<Result<(), LinkError>> {
    thread::spawn(move || {
        let mut arm = Watched {
            session,
            shared,
            pace,
        };
        let served = arm.serve(&orders);
        let ended = arm.session.stop_after(served);
        if let Err(error) = &ended {
            arm.shared.note_failure(format!(" ({error})"));
        }
        ended
    })
}

/// A session that looks for emergency stops whenever its time passes, and tells its status.
struct Watched {
    session: Session,
    shared: Arc<Shared>,
    pace: Pace,
}

impl Drop for Watched {
    /// Also where the thread panics.
    fn drop(&mut self) {
        self.shared.note_end();
    }
}

impl Controlled for Watched {
    type Line = Box<dyn Connection>;

    fn client(&mut self) -> &mut Client<Self::Line> {
        &mut self.session.client
    }

    fn pass_time(&mut self) -> Result<(), LinkError> {
        self.stop_if_asked()?;
        Controlled::pass_time(&mut self.session)?;
        self.session.read_status()?;
        self.shared.note(&self.session.status);
        Ok(())
    }

    fn note_stream(&mut self, state: &StreamState) {
        self.shared.note_stream(state);
    }
}

impl Watched {
    fn stop_if_asked(&mut self) -> Result<(), LinkError> {
        let asked = self.shared.emergencies();
        if !asked.is_empty() {
            // It is never refused.
            let _ = self.session.request(Request::EmergencyStop)?;
            self.session.read_status()?;
            self.shared.note(&self.session.status);
        }
        for done in asked {
            // Who asked may be gone.
            let _ = done.send(());
        }
        Ok(())
    }

    fn serve(&mut self, orders: &Receiver<Order>) -> Result<(), LinkError> {
        for _ in 0..WAKING {
            Controlled::pass_time(self)?;
        }
        loop {
            let order = match (self.pace, orders.try_recv()) {
                (Pace::RealTime, Err(TryRecvError::Empty)) => {
                    Controlled::pass_time(self)?;
                    continue;
                }
                // Its time stands still between the calls.
                (Pace::AsFastAsPossible, Err(TryRecvError::Empty)) => orders.recv().ok(),
                (_, order) => order.ok(),
            };
            let Some(order) = order else {
                return Ok(());
            };
            self.stop_if_asked()?;
            let Order::Call { task, busy, answer } = order else {
                continue;
            };
            let done = self.do_task(&task);
            let broken = match &done {
                Err(DriveError::Link(LinkError::Silent | LinkError::Connection(_))) => true,
                Ok(()) | Err(_) => false,
            };
            if !broken {
                self.session.read_status()?;
                self.shared.note(&self.session.status);
            }
            drop(busy);
            // Who asked may be gone.
            let _ = answer.send(done);
            if broken {
                return Err(LinkError::Silent);
            }
        }
    }

    fn do_task(&mut self, task: &Task) -> Outcome {
        let (shared, pace) = (self.shared.clone(), self.pace);
        let tick_rate = f64::from(self.session.settings.control.tick_rate);
        let wants_stop = || shared.wants_stop();
        let mut drive = Drive::new(self, &wants_stop);
        match task {
            Task::Home(homing) => drive.home(*homing),
            Task::MotorsOn => drive.switch_on(),
            Task::MotorsOff => drive.switch_off(),
            Task::ClearFault => drive.clear_fault(),
            Task::Stream { options, given } => {
                drive.follow_stream(options, tick_rate, &mut || next(given, pace, &shared))
            }
            Task::BeLed { seconds, record } => drive.be_led(tick_rate, &mut |state| {
                let mut record = record.lock().unwrap_or_else(PoisonError::into_inner);
                record.keep(state) && record.time() < *seconds
            }),
            Task::Follow {
                moves,
                pauses,
                power,
            } => {
                if *power {
                    drive.switch_on()?;
                }
                let mut progress = |taken: usize, _: &Status| shared.note_moves(taken, moves.len());
                let mut goes_on = |pause: &Pause| Ok(shared.waits_at(&pause.text));
                let done = drive.follow_armed(moves, pauses, &mut progress, &mut goes_on);
                match (power, &done) {
                    // A fault has switched them off, or holds the arm.
                    (true, Ok(()) | Err(DriveError::Stopped(_) | DriveError::Move(_))) => {
                        done.and(drive.switch_off())
                    }
                    _ => done,
                }
            }
        }
    }
}

/// What the program gives now. The time of an arm that keeps no real time stands still until it gives something.
fn next(given: &Receiver<Given>, pace: Pace, shared: &Shared) -> Given {
    match pace {
        Pace::RealTime => match given.recv_timeout(NEXT) {
            Ok(given) => given,
            Err(RecvTimeoutError::Timeout) => Given::Nothing,
            Err(RecvTimeoutError::Disconnected) => Given::End,
        },
        Pace::AsFastAsPossible => loop {
            match given.recv_timeout(LOOK) {
                Ok(given) => return given,
                Err(RecvTimeoutError::Disconnected) => return Given::End,
                Err(RecvTimeoutError::Timeout) if shared.is_interrupted() => return Given::Nothing,
                Err(RecvTimeoutError::Timeout) => {}
            }
        },
    }
}
