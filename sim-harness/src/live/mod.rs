//! An arm that a program commands call by call.
//!
//! A thread speaks with the controller all the time. So the controller sees its host while the program thinks, and an
//! emergency stop waits for no call. One call is done at a time.

mod shared;
mod thread;

#[cfg(test)]
mod tests;

use crate::clock::Clock;
use crate::controller::{ControllerSource, OpenError, open};
use crate::drive::{DriveError, Given, Homing, job_moves, planner_at};
use crate::link::LinkError;
use crate::streaming::{SetPoint, StreamOptions};
use crate::teaching::{Record, ReplayError, TaughtPath, TeachError};
use fivebar_files::job::{Job, Pause};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::motion::Impedance;
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::CheckedSettings;
use fivebar_firmware::{FULL_TOOL, Move, MoveKind, Status};
use shared::{Busy, Shared};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender, SyncSender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;
use thread::{Order, Outcome, Task};

pub use shared::Progress;

/// Rest in which a tool moves [s]; the planner adds the time of a servo.
const TOOL_TIME: f32 = 1e-3;

/// Why a call is not done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LiveError {
    /// Another call is being done.
    #[error("the arm is busy with another call: wait for it, or stop it")]
    Busy,
    /// A move of its own needs motors that are on.
    #[error("the motors are off: switch them on first")]
    MotorsOff,
    /// The tool cannot be moved by itself.
    #[error("the arm has no pen: its tool is none, or works along strokes only")]
    NoPen,
    /// The connection has ended.
    #[error("the connection to the controller has ended{0}: connect again")]
    Ended(String),
    /// What a hand has taught is no path.
    #[error(transparent)]
    Teach(#[from] TeachError),
    /// A taught path is not replayed.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// The call was refused or ended early.
    #[error(transparent)]
    Drive(#[from] DriveError),
}

impl From<LinkError> for LiveError {
    fn from(error: LinkError) -> Self {
        Self::Drive(error.into())
    }
}

/// How the time of a simulated arm passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// As on the machine.
    RealTime,
    /// As fast as it can be computed, and only while a call is done.
    AsFastAsPossible,
}

/// A connection to a controller, whose thread keeps it alive.
pub struct LiveArm {
    robot: Robot,
    settings: CheckedSettings,
    place: String,
    shared: Arc<Shared>,
    /// None after [`Self::close`].
    orders: Mutex<Option<Sender<Order>>>,
    thread: Mutex<Option<JoinHandle<Result<(), LinkError>>>>,
}

/// A call that is being done.
pub struct Pending {
    answer: Receiver<Outcome>,
    shared: Arc<Shared>,
}

impl Pending {
    /// Waits for the answer; none: it is not there yet.
    pub fn wait(&self, time: Duration) -> Option<Result<(), LiveError>> {
        match self.answer.recv_timeout(time) {
            Ok(answer) => Some(answer.map_err(LiveError::Drive)),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => Some(Err(self.shared.ended())),
        }
    }

    /// Waits until the call is done.
    ///
    /// # Errors
    /// Why it is not.
    pub fn finish(self) -> Result<(), LiveError> {
        match self.answer.recv() {
            Ok(answer) => Ok(answer?),
            Err(_) => Err(self.shared.ended()),
        }
    }
}

/// A stream in progress.
pub struct LiveStream {
    points: SyncSender<Given>,
    pending: Pending,
}

impl LiveStream {
    /// Gives the next point. Waits while the points before it last longer than the stream's delay. Returns whether the
    /// stream goes on: [`Self::finish`] says why not.
    pub fn send(&self, point: SetPoint) -> bool {
        self.points.send(Given::Point(point)).is_ok()
    }

    /// Changes the springs and dampers of a stream with an impedance, in 0.1 s. Waits and returns as [`Self::send`].
    pub fn change(&self, impedance: Impedance) -> bool {
        self.points.send(Given::Spring(impedance)).is_ok()
    }

    /// Ends the stream, and waits until the arm rests behind the last point.
    ///
    /// # Errors
    /// Why the stream has ended before.
    pub fn finish(self) -> Result<(), LiveError> {
        drop(self.points);
        self.pending.finish()
    }
}

impl LiveArm {
    /// Opens the controller of this robot and begins to speak with it.
    ///
    /// # Errors
    /// The controller cannot be opened, or is for another arm.
    pub fn open(
        robot: &Robot,
        source: ControllerSource<'_>,
        pace: Pace,
    ) -> Result<Self, OpenError> {
        let clock = match pace {
            Pace::RealTime => Clock::real(),
            Pace::AsFastAsPossible => Clock::simulated(),
        };
        let (session, place) = open(robot, source, &clock)?;
        let settings = session.settings;
        let shared = Arc::new(Shared::new(session.status));
        let (orders, received) = mpsc::channel();
        let thread = thread::spawn(session, received, shared.clone(), pace);
        Ok(Self {
            robot: robot.clone(),
            settings,
            place,
            shared,
            orders: Mutex::new(Some(orders)),
            thread: Mutex::new(Some(thread)),
        })
    }

    /// Where the controller runs.
    pub fn place(&self) -> &str {
        &self.place
    }

    /// The robot.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// What is known of the arm now.
    pub fn progress(&self) -> Progress {
        self.shared.progress()
    }

    /// Makes the joint angles known.
    ///
    /// # Errors
    /// Another call is being done, or the connection has ended; all other reasons come with the answer.
    pub fn home(&self, homing: Homing) -> Result<Pending, LiveError> {
        let busy = self.shared.begin()?;
        self.order(busy, Task::Home(homing))
    }

    /// Switches the motors on; the arm holds its place.
    ///
    /// # Errors
    /// As [`Self::home`].
    pub fn motors_on(&self) -> Result<Pending, LiveError> {
        let busy = self.shared.begin()?;
        self.order(busy, Task::MotorsOn)
    }

    /// Switches the motors off.
    ///
    /// # Errors
    /// As [`Self::home`].
    pub fn motors_off(&self) -> Result<Pending, LiveError> {
        let busy = self.shared.begin()?;
        self.order(busy, Task::MotorsOff)
    }

    /// Clears a latched fault.
    ///
    /// # Errors
    /// As [`Self::home`].
    pub fn clear_fault(&self) -> Result<Pending, LiveError> {
        let busy = self.shared.begin()?;
        self.order(busy, Task::ClearFault)
    }

    /// Moves the tool in a straight line to this point [m] with at most this speed [m/s]. The motors are on.
    ///
    /// # Errors
    /// As [`Self::home`], or the move cannot be done: then nothing moves.
    pub fn move_to(&self, to: [f32; 2], speed: f32) -> Result<Pending, LiveError> {
        self.do_move(MoveKind::Line { to, feed: speed })
    }

    /// Turns the joints to these angles θ1, θ4 [rad] with at most this share of their greatest speed. The motors are on.
    ///
    /// # Errors
    /// As [`Self::move_to`].
    pub fn move_joints(&self, to: [f32; 2], speed: f32) -> Result<Pending, LiveError> {
        self.do_move(MoveKind::Joint { to, speed })
    }

    /// Of the controller [Hz].
    pub fn tick_rate(&self) -> f64 {
        self.settings.control.tick_rate.into()
    }

    /// Begins a stream of set-points where the arm is. The motors are on.
    ///
    /// # Errors
    /// As [`Self::home`].
    pub fn stream(&self, options: StreamOptions) -> Result<LiveStream, LiveError> {
        let busy = self.shared.begin()?;
        let (status, _) = self.ready()?;
        if status.state == State::Stopped {
            return Err(LiveError::MotorsOff);
        }
        // The thread takes a point when it is due.
        let (points, given) = mpsc::sync_channel(0);
        let pending = self.order(busy, Task::Stream { options, given })?;
        Ok(LiveStream { points, pending })
    }

    /// Lets a hand lead the arm for so long [s], or until it is stopped; then it is held. The motors are on. What the hand has done
    /// is in the record.
    ///
    /// # Errors
    /// As [`Self::home`].
    pub fn be_led(&self, seconds: f64) -> Result<(Pending, Arc<Mutex<Record>>), LiveError> {
        let busy = self.shared.begin()?;
        let (status, _) = self.ready()?;
        if status.state == State::Stopped {
            return Err(LiveError::MotorsOff);
        }
        let record = Arc::new(Mutex::new(Record::new(
            self.settings.control.tick_rate.into(),
        )));
        let task = Task::BeLed {
            seconds,
            record: record.clone(),
        };
        Ok((self.order(busy, task)?, record))
    }

    /// The path that a hand has led the tip along.
    ///
    /// # Errors
    /// The arm was not moved, or its angles close no arm.
    pub fn taught(&self, record: &Mutex<Record>) -> Result<TaughtPath, LiveError> {
        let (status, _) = self.ready()?;
        let assembly = planner_at(&self.settings, &status)?.assembly();
        let tool = self.robot.tool_on_link();
        let tool = tool.map_err(|_| DriveError::NoTool)?;
        Ok(lock(record).path(&self.robot.name, &tool, assembly)?)
    }

    /// Does a taught motion again, at this multiple of its speed. The motors are on.
    ///
    /// # Errors
    /// As [`Self::move_to`].
    pub fn replay(&self, path: &TaughtPath, speed: f64) -> Result<Pending, LiveError> {
        let busy = self.shared.begin()?;
        let (status, tool) = self.ready()?;
        let planner = planner_at(&self.settings, &status)?;
        let moves = path.replay(speed, &planner, tool, status.angle)?;
        self.follow(busy, moves, None)
    }

    /// Puts the tool at this level, 0 (up or off) to 1, where the arm rests. The motors are on.
    ///
    /// # Errors
    /// As [`Self::move_to`].
    pub fn set_tool(&self, level: f32) -> Result<Pending, LiveError> {
        if !self.settings.tool_output.waits() {
            return Err(LiveError::NoPen);
        }
        let busy = self.shared.begin()?;
        let duration = TOOL_TIME;
        let moves = vec![Move {
            tag: 0,
            tool: tool_level(level),
            kind: MoveKind::Dwell { duration },
        }];
        self.follow(busy, moves, None)
    }

    /// Draws a job from where the tool is. Motors that are off are switched on for it.
    ///
    /// # Errors
    /// As [`Self::move_to`].
    pub fn draw(&self, scenario: &Scenario, job: &Job) -> Result<Pending, LiveError> {
        let busy = self.shared.begin()?;
        let (status, tool) = self.ready()?;
        let mut planner = planner_at(&self.settings, &status)?;
        let (moves, pauses) = job_moves(scenario, job, tool, &mut planner)?;
        self.follow(busy, moves, Some(pauses))
    }

    /// Goes on after a pause of a job.
    pub fn go_on(&self) {
        self.shared.go_on();
    }

    /// Brings the arm to rest on its path and ends the present call; the motors stay on. Returns when the call has ended.
    pub fn stop(&self) {
        self.shared.stop();
    }

    /// Switches the motors off at once, whatever is being done.
    ///
    /// # Errors
    /// The connection has ended; the controller then stops the arm by itself.
    pub fn emergency_stop(&self) -> Result<(), LiveError> {
        let done = self.shared.ask_for_emergency_stop();
        // A thread that waits for orders looks for it when it gets one.
        if let Some(orders) = &*lock(&self.orders) {
            let _ = orders.send(Order::Look);
        }
        done.recv().map_err(|_| self.shared.ended())
    }

    /// Ends the present call, brings the arm to rest, switches the motors off and ends the connection. Does nothing if it
    /// has ended.
    ///
    /// # Errors
    /// The connection failed; the controller then stops the arm by itself.
    pub fn close(&self) -> Result<(), LiveError> {
        drop(lock(&self.orders).take());
        self.shared.stop();
        match lock(&self.thread).take() {
            Some(thread) => match thread.join() {
                Ok(ended) => Ok(ended?),
                Err(_) => Err(self.shared.ended()),
            },
            None => Ok(()),
        }
    }

    fn do_move(&self, kind: MoveKind) -> Result<Pending, LiveError> {
        let busy = self.shared.begin()?;
        let tool = tool_level(self.shared.progress().status.tool_level);
        self.follow(busy, vec![Move { tag: 0, tool, kind }], None)
    }

    /// Checks moves from where the arm is, and orders them. Those of a job have pauses.
    fn follow(
        &self,
        busy: Busy,
        moves: Vec<Move>,
        job: Option<Vec<Pause>>,
    ) -> Result<Pending, LiveError> {
        let (status, tool) = self.ready()?;
        let mut planner = planner_at(&self.settings, &status)?;
        planner
            .check_all_from(tool, Some(status.angle), &moves)
            .map_err(DriveError::Move)?;
        let power = status.state == State::Stopped;
        if power && job.is_none() {
            return Err(LiveError::MotorsOff);
        }
        let task = Task::Follow {
            moves,
            pauses: job.unwrap_or_default(),
            power,
        };
        self.order(busy, task)
    }

    /// The status of an arm without a fault, and its tool [m], which is known.
    fn ready(&self) -> Result<(Status, [f32; 2]), DriveError> {
        let status = self.shared.progress().status;
        match (status.fault, status.tool.filter(|_| status.homed)) {
            (Some(fault), _) => Err(DriveError::Fault(fault)),
            (None, Some(tool)) => Ok((status, tool)),
            (None, None) => Err(DriveError::NotHomed),
        }
    }

    fn order(&self, busy: Busy, task: Task) -> Result<Pending, LiveError> {
        let (order, answer) = Order::new(task, busy);
        let sent = match &*lock(&self.orders) {
            Some(orders) => orders.send(order).is_ok(),
            None => false,
        };
        match sent {
            true => Ok(Pending {
                answer,
                shared: self.shared.clone(),
            }),
            false => Err(self.shared.ended()),
        }
    }
}

impl Drop for LiveArm {
    fn drop(&mut self) {
        // A failed connection has no one left to tell of it.
        let _ = self.close();
    }
}

fn tool_level(share: f32) -> u16 {
    (share.clamp(0.0, 1.0) * f32::from(FULL_TOOL)).round() as u16
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
