//! The thread that exchanges messages with the controller.

use super::ServeError;
use super::command_error::sentence;
use super::lease::{ControlLease, PageId};
use super::message::{ControllerEnd, FaultMessage, JobMessage, ServerMessage, StateMessage};
use super::move_feeder::{JobStatus, MoveFeeder};
use super::pace::SpeedMeter;
use super::preview::Preview;
use super::simulated::SteppedArm;
use crate::input::job::Job;
use crate::input::robot::Robot;
use crate::run::link::{Client, LinkError};
use crate::run::simulation::fault_name;
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::protocol::{CommandError, HostCommand, Reply};
use fivebar_firmware::safety::{self, Fault};
use fivebar_firmware::settings::CheckedSettings;
use fivebar_firmware::{Move, Request, Status};
use std::io::{Read, Write};
use std::time::{Duration, Instant};

/// States sent to pages per second of the controller's time [Hz].
const SAMPLES: f32 = 30.0;
/// The same for a board in lockstep, whose time runs slower than real time [Hz].
const SAMPLES_STEPPED: f32 = 200.0;
/// Longest time for the arm to come to rest when the program ends.
const LONGEST_STOP: Duration = Duration::from_secs(5);

/// A stream of bytes to a controller.
pub(super) trait Connection: Read + Write + Send {}
impl<L: Read + Write + Send> Connection for L {}

/// One controller and the pages that show it.
pub(super) struct ControllerThread {
    pub(super) client: Client<Box<dyn Connection>>,
    /// The simulated arm of a board in lockstep.
    stepped: Option<SteppedArm>,
    pub(super) pages: ControllerEnd,
    pub(super) robot: Robot,
    pub(super) settings: CheckedSettings,
    pub(super) preview: Preview,
    pub(super) lease: ControlLease,
    pub(super) feeder: MoveFeeder,
    pub(super) status: Status,
    /// The fault last sent to all pages, or that there is none; `None` before the first.
    pub(super) sent_fault: Option<Option<Fault>>,
    pub(super) loaded: Option<LoadedJob>,
    speed: SpeedMeter,
}

/// A job that can be run.
pub(super) struct LoadedJob {
    pub(super) job: Job,
    pub(super) moves: Vec<Move>,
    /// The message about it to the pages.
    pub(super) message: JobMessage,
}

impl ControllerThread {
    /// Starts the controller's telemetry.
    pub(super) fn new(
        mut client: Client<Box<dyn Connection>>,
        stepped: Option<SteppedArm>,
        robot: Robot,
        settings: CheckedSettings,
        pages: ControllerEnd,
    ) -> Result<Self, ServeError> {
        let samples = if stepped.is_some() {
            SAMPLES_STEPPED
        } else {
            SAMPLES
        };
        let every = (settings.control.tick_rate / samples) as u16;
        client.call(HostCommand::Telemetry { every })?;
        let (status, _) = client.status()?;
        Ok(Self {
            client,
            stepped,
            pages,
            robot,
            settings,
            preview: Preview::new(&settings),
            lease: ControlLease::default(),
            feeder: MoveFeeder::default(),
            status,
            sent_fault: None,
            loaded: None,
            speed: SpeedMeter::from(0.0, Instant::now()),
        })
    }

    /// Runs until `ends` returns true or the connection fails. In the first case it then
    /// brings the arm to rest and disarms it.
    pub(super) fn run(mut self, ends: &dyn Fn() -> bool) -> Result<(), ServeError> {
        while !ends() {
            self.cycle()?;
        }
        Ok(self.stop_arm()?)
    }

    fn cycle(&mut self) -> Result<(), LinkError> {
        while let Ok((page, event)) = self.pages.events.try_recv() {
            self.handle_event(page, event)?;
        }
        // Without a message from the page in control, the host sends no command either.
        if self.lease.is_alive(Instant::now()) {
            self.feed_controller()?;
        }
        self.pass_time()?;
        while let Some(sample) = self.client.take_telemetry() {
            let homed = sample.status.homed && !self.status.homed;
            self.status = sample.status;
            if homed {
                self.preview_job();
            }
            self.send_state()?;
        }
        Ok(())
    }

    fn pass_time(&mut self) -> Result<(), LinkError> {
        match &mut self.stepped {
            Some(arm) => arm.step(&mut self.client),
            None => self.client.poll(),
        }
    }

    /// Gives the controller a sign of life and the moves that wait.
    fn feed_controller(&mut self) -> Result<(), LinkError> {
        let (status, mut room) = self.client.status()?;
        match self.feeder.update(&status, room) {
            JobStatus::Unchanged => {}
            JobStatus::Finished => self.notice("The job is done."),
            JobStatus::Cancelled => self.notice("The rest of the job is cancelled."),
        }
        while let Some(next) = self.feeder.next(room) {
            match self.client.call(HostCommand::Move(next))? {
                Reply::Refused(CommandError::Move(refusal))
                    if refusal.kind == MoveErrorKind::Full =>
                {
                    break;
                }
                Reply::Refused(refusal) => {
                    self.feeder.refused();
                    self.refuse(None, sentence(&refusal));
                }
                Reply::Taken { room: left } => {
                    self.feeder.taken(&next);
                    room = left;
                }
                other => {
                    self.feeder.refused();
                    self.refuse(None, format!("Unexpected reply to a move: {other:?}."));
                }
            }
        }
        Ok(())
    }

    /// Whether the arm rests, with bridges on or off.
    pub(super) fn rests(&self) -> bool {
        use safety::State::{Armed, Fault, Homing, Running, Stopped, Stopping};
        match self.status.state {
            Stopped | Armed | Fault => true,
            Homing | Running | Stopping => false,
        }
    }

    fn stop_arm(&mut self) -> Result<(), LinkError> {
        let deadline = Instant::now() + LONGEST_STOP;
        // Both requests are refused if a fault is latched: then the controller itself
        // brings the arm to rest.
        let _ = self.client.command(HostCommand::Request(Request::Stop))?;
        loop {
            (self.status, _) = self.client.status()?;
            if self.rests() || Instant::now() > deadline {
                break;
            }
            self.pass_time()?;
        }
        let _ = self.client.command(HostCommand::Request(Request::Disarm))?;
        Ok(())
    }

    fn send_state(&mut self) -> Result<(), LinkError> {
        if self.sent_fault != Some(self.status.fault) {
            self.sent_fault = Some(self.status.fault);
            let snapshot = match self.status.fault {
                Some(_) => self.client.call(HostCommand::Snapshot)?,
                None => Reply::Snapshot(None),
            };
            if let Reply::Snapshot(snapshot) = snapshot {
                self.pages
                    .send(&ServerMessage::Fault(snapshot.map(|snapshot| {
                        FaultMessage {
                            name: fault_name(snapshot.fault),
                            snapshot,
                        }
                    })));
            }
        }
        let status = &self.status;
        let time = f64::from(status.tick) / f64::from(self.settings.control.tick_rate);
        let now = Instant::now();
        let pose = self.preview.pose(status);
        self.pages.send(&ServerMessage::State(StateMessage {
            status,
            time,
            speed: self.speed.at(time, now),
            joints: pose.map(|pose| [pose.b, pose.c, pose.d].map(|point| [point.x, point.y])),
            elbows: pose.map(|pose| self.preview.elbows(&pose)),
            control: self.lease.holder(),
            alive: self.lease.is_alive(now),
            progress: self.feeder.progress(),
        }));
        Ok(())
    }

    /// Sends a notice to all pages.
    pub(super) fn notice(&self, text: &str) {
        self.pages.send(&ServerMessage::Notice {
            to: None,
            refused: false,
            text: text.into(),
        });
    }

    /// Sends a refusal to one page, or to all.
    pub(super) fn refuse(&self, to: Option<PageId>, text: String) {
        self.pages.send(&ServerMessage::Notice {
            to,
            refused: true,
            text,
        });
    }
}
