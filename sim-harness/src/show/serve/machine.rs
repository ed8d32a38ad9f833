//! The thread that talks with the controller.

use super::ServeError;
use super::lease::{ControlLease, PageId};
use super::message::{FaultNews, JobNews, MachineSide, News, State};
use super::move_feeder::{MoveFeeder, Turn};
use super::pace::Speed;
use super::preview::Preview;
use super::refusal::sentence;
use super::simulated::SteppedArm;
use crate::input::job::Job;
use crate::input::robot::Robot;
use crate::run::link::{Client, LinkError};
use crate::run::simulation::fault_name;
use fivebar_firmware::planner::Reason;
use fivebar_firmware::protocol::{Order, Refusal, Reply};
use fivebar_firmware::safety::{self, Fault};
use fivebar_firmware::{Move, Request, Settings, Status};
use std::io::{Read, Write};
use std::time::{Duration, Instant};

/// Samples that pages are shown in a second.
const SAMPLES: f32 = 30.0;
/// The same of a board that is stepped, whose seconds are long ones.
const SAMPLES_STEPPED: f32 = 200.0;
/// How long the arm may take to come to rest when the program ends.
const LONGEST_STOP: Duration = Duration::from_secs(5);

/// A stream of bytes to a controller.
pub(super) trait Line: Read + Write + Send {}
impl<L: Read + Write + Send> Line for L {}

/// One controller and all who look at it.
pub(super) struct Machine {
    pub(super) client: Client<Box<dyn Line>>,
    /// The arm of a board that makes no ticks by itself.
    stepped: Option<SteppedArm>,
    pub(super) pages: MachineSide,
    pub(super) robot: Robot,
    pub(super) settings: Settings,
    pub(super) preview: Preview,
    pub(super) lease: ControlLease,
    pub(super) feeder: MoveFeeder,
    pub(super) status: Status,
    /// The fault, or its absence, that all pages have been told of.
    pub(super) told: Option<Option<Fault>>,
    pub(super) loaded: Option<Loaded>,
    speed: Speed,
}

/// A job that waits to be done.
pub(super) struct Loaded {
    pub(super) job: Job,
    pub(super) moves: Vec<Move>,
    /// What pages have been told of it.
    pub(super) news: JobNews,
}

impl Machine {
    /// Has the controller send samples.
    pub(super) fn new(
        mut client: Client<Box<dyn Line>>,
        stepped: Option<SteppedArm>,
        robot: Robot,
        settings: Settings,
        pages: MachineSide,
    ) -> Result<Self, ServeError> {
        let samples = if stepped.is_some() {
            SAMPLES_STEPPED
        } else {
            SAMPLES
        };
        let every = (settings.control.tick_rate / samples) as u16;
        client.call(Order::Telemetry { every })?;
        let (status, _) = client.status()?;
        Ok(Self {
            client,
            stepped,
            pages,
            robot,
            settings,
            preview: Preview::new(&settings)?,
            lease: ControlLease::default(),
            feeder: MoveFeeder::default(),
            status,
            told: None,
            loaded: None,
            speed: Speed::from(0.0, Instant::now()),
        })
    }

    /// Goes on until the line breaks or `ends` says so; then the arm is brought to rest
    /// and its bridges are off.
    pub(super) fn run(mut self, ends: &dyn Fn() -> bool) -> Result<(), ServeError> {
        while !ends() {
            self.turn()?;
        }
        Ok(self.leave()?)
    }

    fn turn(&mut self) -> Result<(), LinkError> {
        while let Ok((page, event)) = self.pages.events.try_recv() {
            self.hear(page, event)?;
        }
        // Where the page in control falls silent, so does the host.
        if self.lease.is_alive(Instant::now()) {
            self.attend()?;
        }
        self.pass_time()?;
        while let Some(sample) = self.client.take_telemetry() {
            let homed = sample.status.homed && !self.status.homed;
            self.status = sample.status;
            if homed {
                self.preview_job();
            }
            self.tell_state()?;
        }
        Ok(())
    }

    fn pass_time(&mut self) -> Result<(), LinkError> {
        match &mut self.stepped {
            Some(arm) => arm.step(&mut self.client),
            None => self.client.poll(),
        }
    }

    /// Shows the controller that its host lives, and gives it moves.
    fn attend(&mut self) -> Result<(), LinkError> {
        let (status, mut room) = self.client.status()?;
        match self.feeder.look(&status, room) {
            Turn::Quiet => {}
            Turn::Finished => self.notice("The job is done."),
            Turn::Abandoned => self.notice("The rest of the job is forgotten."),
        }
        while let Some(order) = self.feeder.next(room) {
            match self.client.call(Order::Move(order))? {
                Reply::Refused(Refusal::Move(refusal)) if refusal.reason == Reason::Full => break,
                Reply::Refused(refusal) => {
                    self.feeder.refused();
                    self.refuse(None, sentence(&refusal));
                }
                Reply::Taken { room: left } => {
                    self.feeder.taken(&order);
                    room = left;
                }
                other => {
                    self.feeder.refused();
                    self.refuse(None, format!("The controller answers a move by {other:?}."));
                }
            }
        }
        Ok(())
    }

    /// Whether the arm rests, powered or not.
    pub(super) fn rests(&self) -> bool {
        use safety::State::{Armed, Fault, Homing, Running, Stopped, Stopping};
        match self.status.state {
            Stopped | Armed | Fault => true,
            Homing | Running | Stopping => false,
        }
    }

    fn leave(&mut self) -> Result<(), LinkError> {
        let deadline = Instant::now() + LONGEST_STOP;
        // Either is refused where a fault is latched: then the arm rests by itself.
        let _ = self.client.command(Order::Request(Request::Stop))?;
        loop {
            (self.status, _) = self.client.status()?;
            if self.rests() || Instant::now() > deadline {
                break;
            }
            self.pass_time()?;
        }
        let _ = self.client.command(Order::Request(Request::Disarm))?;
        Ok(())
    }

    fn tell_state(&mut self) -> Result<(), LinkError> {
        if self.told != Some(self.status.fault) {
            self.told = Some(self.status.fault);
            let snapshot = match self.status.fault {
                Some(_) => self.client.call(Order::Snapshot)?,
                None => Reply::Snapshot(None),
            };
            if let Reply::Snapshot(snapshot) = snapshot {
                self.pages
                    .tell(&News::Fault(snapshot.map(|snapshot| FaultNews {
                        name: fault_name(snapshot.fault),
                        snapshot,
                    })));
            }
        }
        let status = &self.status;
        let time = f64::from(status.tick) / f64::from(self.settings.control.tick_rate);
        let now = Instant::now();
        let pose = self.preview.pose(status);
        self.pages.tell(&News::State(State {
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

    /// Tells all pages of something that was done.
    pub(super) fn notice(&self, text: &str) {
        self.pages.tell(&News::Notice {
            to: None,
            refused: false,
            text: text.into(),
        });
    }

    /// Tells a page, or all, of something that was not done.
    pub(super) fn refuse(&self, to: Option<PageId>, text: String) {
        self.pages.tell(&News::Notice {
            to,
            refused: true,
            text,
        });
    }
}
