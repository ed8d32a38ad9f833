//! The thread that talks with the controller.

use super::ServeError;
use super::feed::{Feed, Turn};
use super::message::{Event, FaultNews, JobNews, MachineSide, News, State, Wanted, Wish};
use super::pilot::{Client, Pilot};
use super::refusal::sentence;
use super::sketch::{Sketch, nearest};
use crate::link::{Conversation, LinkError};
use crate::robot::Robot;
use crate::run::{RunError, Scenario, fault_name};
use fivebar_firmware::planner::Reason;
use fivebar_firmware::protocol::{Order, Refusal, Reply};
use fivebar_firmware::safety::Fault;
use fivebar_firmware::{Move, MoveKind, Settings, Status};
use fivebar_kinematics::five_bar::Side;
use std::io::{Read, Write};
use std::time::Instant;

/// Samples that pages are shown in a second.
const SAMPLES: f32 = 30.0;
/// Share of the joints' greatest speed at which a joint is dragged and the mode changed.
const JOINT_SPEED: f32 = 0.4;

/// One controller and all who look at it.
pub(super) struct Machine<L> {
    conversation: Conversation<L>,
    pages: MachineSide,
    robot: Robot,
    settings: Settings,
    sketch: Sketch,
    pilot: Pilot,
    feed: Feed,
    status: Status,
    /// The fault that pages have been told of.
    told: Option<Fault>,
    loaded: Option<(Vec<Move>, JobNews)>,
}

impl<L: Read + Write> Machine<L> {
    /// Asks the controller for its settings and has it send samples.
    pub(super) fn new(
        mut conversation: Conversation<L>,
        robot: Robot,
        pages: MachineSide,
    ) -> Result<Self, ServeError> {
        let mut settings = robot.settings().map_err(RunError::from)?;
        conversation.read_settings(&mut settings)?;
        let every = (settings.control.tick_rate / SAMPLES) as u16;
        conversation.ask(Order::Telemetry { every })?;
        let (status, _) = conversation.status()?;
        Ok(Self {
            sketch: Sketch::new(&settings)?,
            conversation,
            pages,
            robot,
            settings,
            pilot: Pilot::default(),
            feed: Feed::default(),
            status,
            told: None,
            loaded: None,
        })
    }

    /// Goes on until the line breaks.
    pub(super) fn run(mut self) -> ServeError {
        loop {
            if let Err(error) = self.turn() {
                return error.into();
            }
        }
    }

    fn turn(&mut self) -> Result<(), LinkError> {
        while let Ok((client, event)) = self.pages.events.try_recv() {
            self.hear(client, event)?;
        }
        // Where the page in control falls silent, so does the host.
        if self.pilot.is_alive(Instant::now()) {
            self.attend()?;
        }
        self.conversation.listen()?;
        while let Some(sample) = self.conversation.take_telemetry() {
            self.status = sample.status;
            self.tell_state()?;
        }
        Ok(())
    }

    /// Shows the controller that its host lives, and gives it moves.
    fn attend(&mut self) -> Result<(), LinkError> {
        let (status, mut room) = self.conversation.status()?;
        self.status = status;
        match self.feed.look(&status, room) {
            Turn::Quiet => {}
            Turn::Finished => self.notice("The job is done."),
            Turn::Abandoned => self.notice("The rest of the job is forgotten."),
        }
        while let Some(order) = self.feed.next(room) {
            match self.conversation.ask(Order::Move(order))? {
                Reply::Refused(Refusal::Move(refusal)) if refusal.reason == Reason::Full => break,
                Reply::Refused(refusal) => {
                    self.feed.refused();
                    self.refuse(None, sentence(&refusal));
                }
                Reply::Taken { room: left } => {
                    self.feed.taken(&order);
                    room = left;
                }
                other => self.refuse(None, format!("The controller answers a move by {other:?}.")),
            }
        }
        Ok(())
    }

    fn hear(&mut self, client: Client, event: Event) -> Result<(), LinkError> {
        let now = Instant::now();
        let wish = match event {
            Event::Joined => {
                if self.pilot.client().is_none() {
                    self.pilot.take(client, now);
                }
                self.told = None;
                if let Some((_, job)) = &self.loaded {
                    self.pages.tell(&News::Job(job));
                }
                return Ok(());
            }
            Event::Left => {
                if self.pilot.leave(client) {
                    self.feed.clear();
                }
                return Ok(());
            }
            Event::Wish(wish) => wish,
        };
        let in_control = self.pilot.hear(client, now);
        match wish {
            Wish::Alive => {}
            Wish::Control if in_control => {}
            Wish::Control if self.pilot.take(client, now) => self.feed.clear(),
            Wish::Control => self.refuse(Some(client), "Another page is in control.".into()),
            Wish::Request(wanted) if in_control || wanted.is_open_to_all() => {
                self.request(client, wanted)?;
            }
            _ if !in_control => {
                self.refuse(
                    Some(client),
                    "This page watches: take control first.".into(),
                );
            }
            Wish::Load { name, text } => self.load(&name, text),
            Wish::Run => self.begin(client),
            _ if self.feed.is_running() => {
                self.refuse(Some(client), "A job is running: stop it first.".into());
            }
            Wish::Jog([dx, dy]) => {
                if let Some([x, y]) = self.feed.end(&self.status) {
                    self.aim([x + dx, y + dy]);
                } else {
                    self.refuse(
                        Some(client),
                        "The arm is not armed: home it, then arm it.".into(),
                    );
                }
            }
            Wish::Follow(to) => self.aim(to),
            Wish::Turn { joint, to } => self.turn_joint(joint, to),
            Wish::Mode(elbows) => self.change_mode(client, elbows),
            Wish::Request(_) => {}
        }
        Ok(())
    }

    fn request(&mut self, client: Client, wanted: Wanted) -> Result<(), LinkError> {
        if matches!(wanted, Wanted::Stop | Wanted::EmergencyStop) {
            self.feed.clear();
        }
        if let Err(refusal) = self.conversation.order(Order::Request(wanted.into()))? {
            self.refuse(Some(client), sentence(&refusal));
        }
        Ok(())
    }

    fn aim(&mut self, to: [f32; 2]) {
        let feed = self.settings.motion.max_speed;
        self.feed.aim_at(MoveKind::Line { to, feed });
    }

    fn turn_joint(&mut self, joint: usize, to: f32) {
        let mut angles = self
            .status
            .joint_reference
            .map_or(self.status.angle, |r| r.angle);
        for ((index, angle), now) in angles.iter_mut().enumerate().zip(self.status.angle) {
            *angle = nearest(if index == joint { to } else { *angle }, now);
        }
        self.aim_joints(angles);
    }

    fn change_mode(&mut self, client: Client, elbows: [Side; 2]) {
        let tool = self.feed.end(&self.status);
        match tool.and_then(|tool| self.sketch.joints(tool, elbows, &self.status)) {
            Some(angles) => self.aim_joints(angles),
            None => self.refuse(
                Some(client),
                "These elbows hold the tool there only beyond links 2 and 3 in line, or not at \
                 all: move the tool first."
                    .into(),
            ),
        }
    }

    fn aim_joints(&mut self, to: [f32; 2]) {
        let speed = JOINT_SPEED;
        self.feed.aim_at(MoveKind::Joint { to, speed });
    }

    fn load(&mut self, name: &str, text: String) {
        let scenario = Scenario::new(name, self.robot.clone(), name, text);
        let job = match scenario.job() {
            Ok(job) => job,
            Err(error) => {
                self.loaded = None;
                let refusal = Some(error.to_string());
                let name = name.into();
                self.pages.tell(&News::Job(&JobNews {
                    name,
                    refusal,
                    ..JobNews::default()
                }));
                return;
            }
        };
        let moves = scenario.moves(&job);
        let news = self.sketch.job(name, &job, &moves, &self.status);
        self.pages.tell(&News::Job(&news));
        self.loaded = Some((moves, news));
    }

    fn begin(&mut self, client: Client) {
        match &self.loaded {
            None => self.refuse(Some(client), "There is no job: load one.".into()),
            Some((
                _,
                JobNews {
                    refusal: Some(why), ..
                },
            )) => {
                self.refuse(Some(client), format!("The job cannot be done. {why}"));
            }
            Some((moves, _)) => {
                self.feed.run(moves.clone());
                self.notice("The job begins.");
            }
        }
    }

    fn tell_state(&mut self) -> Result<(), LinkError> {
        if self.status.fault != self.told {
            let snapshot = match self.conversation.ask(Order::Snapshot)? {
                Reply::Snapshot(snapshot) => snapshot,
                _ => None,
            };
            let news = snapshot.map(|snapshot| FaultNews {
                name: fault_name(snapshot.fault),
                snapshot,
            });
            self.pages.tell(&News::Fault(news));
            self.told = self.status.fault;
        }
        let status = &self.status;
        let pose = self.sketch.pose(status);
        self.pages.tell(&News::State(State {
            status,
            time: f64::from(status.tick) / f64::from(self.settings.control.tick_rate),
            joints: pose.map(|pose| [pose.b, pose.c, pose.d].map(|point| [point.x, point.y])),
            control: self.pilot.client(),
            alive: self.pilot.is_alive(Instant::now()),
            progress: self.feed.progress(),
        }));
        Ok(())
    }

    fn notice(&self, text: &str) {
        self.pages.tell(&News::Notice {
            to: None,
            refused: false,
            text: text.into(),
        });
    }

    fn refuse(&self, to: Option<Client>, text: String) {
        self.pages.tell(&News::Notice {
            to,
            refused: true,
            text,
        });
    }
}
