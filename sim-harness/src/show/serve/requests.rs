//! What pages wish becomes orders, aims and jobs, or a refusal.

use super::lease::PageId;
use super::machine::{Loaded, Machine};
use super::message::{ClientRequest, ControllerRequest, Event, JobNews, Joint, News};
use super::move_feeder::{End, takes_moves};
use super::preview::nearest;
use super::refusal::sentence;
use crate::input::scenario::Scenario;
use crate::run::link::LinkError;
use fivebar_firmware::MoveKind;
use fivebar_firmware::protocol::Order;
use fivebar_kinematics::five_bar::Side;
use std::time::Instant;

/// Share of the joints' greatest speed at which a joint is turned and the mode changed.
const JOINT_SPEED: f32 = 0.4;

/// Why a wish is not done.
type Refused = String;

impl Machine {
    /// Takes note of what happens at a page.
    pub(super) fn hear(&mut self, page: PageId, event: Event) -> Result<(), LinkError> {
        let now = Instant::now();
        match event {
            Event::Joined => {
                // A moving arm whose page is lost comes to rest before another one gets it.
                if self.rests() && !self.lease.is_alive(now) {
                    self.lease.acquire(page, now, false);
                    self.feeder.clear();
                }
                self.tell_again();
            }
            Event::Missed => self.tell_again(),
            Event::Left => {
                if self.lease.release(page) {
                    self.feeder.clear();
                }
            }
            Event::Strange(error) => self.refuse(
                Some(page),
                format!("This page is not of this server's version; load it again ({error})."),
            ),
            Event::Request(request) => {
                let in_control = self.lease.renew(page, now);
                if let Err(why) = self.grant(page, in_control, request)? {
                    self.refuse(Some(page), why);
                }
            }
        }
        Ok(())
    }

    /// What a page that was not there, or too slow, has not heard.
    fn tell_again(&mut self) {
        self.told = None;
        if let Some(loaded) = &self.loaded {
            self.pages.tell(&News::Job(&loaded.news));
        }
    }

    fn grant(
        &mut self,
        page: PageId,
        in_control: bool,
        request: ClientRequest,
    ) -> Result<Result<(), Refused>, LinkError> {
        Ok(match request {
            ClientRequest::Alive => Ok(()),
            ClientRequest::Control => self.hand_over(page),
            ClientRequest::Request(wanted) if in_control || wanted.is_open_to_all() => {
                return self.request(wanted);
            }
            _ if !in_control => Err("This page watches: take control first.".into()),
            ClientRequest::Request(wanted) => return self.request(wanted),
            _ if self.feeder.is_running() => Err("A job is running: stop it first.".into()),
            ClientRequest::Load { name, text } => self.load(&name, text),
            ClientRequest::Run => self.begin(),
            _ if !takes_moves(self.status.state) => {
                Err("The arm is not armed: home it, then arm it.".into())
            }
            ClientRequest::Jog(by) => self.jog(by.map(single)),
            ClientRequest::Follow(to) => {
                self.aim(to.map(single));
                Ok(())
            }
            ClientRequest::JogJoint { joint, by } => {
                self.turn_joint(joint, |angle| angle + single(by))
            }
            ClientRequest::Turn { joint, to } => self.turn_joint(joint, |_| single(to)),
            ClientRequest::Mode(elbows) => self.change_mode(elbows),
        })
    }

    fn hand_over(&mut self, page: PageId) -> Result<(), Refused> {
        let before = self.lease.holder();
        if !self.lease.acquire(page, Instant::now(), self.rests()) {
            return Err(
                "Another page is in control of a moving arm: stop the arm, then take control."
                    .into(),
            );
        }
        if before != Some(page) {
            self.feeder.clear();
            if before.is_some() {
                self.refuse(before, "Another page has taken control.".into());
            }
        }
        Ok(())
    }

    fn request(&mut self, wanted: ControllerRequest) -> Result<Result<(), Refused>, LinkError> {
        if wanted.is_open_to_all() {
            self.feeder.clear();
        }
        let answer = self.client.command(Order::Request(wanted.into()))?;
        Ok(answer.map_err(|refusal| sentence(&refusal)))
    }

    fn jog(&mut self, [dx, dy]: [f32; 2]) -> Result<(), Refused> {
        let [x, y] = self.tool_end().ok_or("The arm is not held anywhere.")?;
        self.aim([x + dx, y + dy]);
        Ok(())
    }

    fn aim(&mut self, to: [f32; 2]) {
        let feed = self.settings.motion.max_speed;
        self.feeder.aim_at(MoveKind::Line { to, feed });
    }

    /// Turns a joint from where the next move begins, the other one staying.
    fn turn_joint(&mut self, joint: Joint, to: impl FnOnce(f32) -> f32) -> Result<(), Refused> {
        let mut angles = self.joints_end().ok_or("The arm is not held anywhere.")?;
        let [theta1, theta4] = &mut angles;
        let angle = match joint {
            Joint::Theta1 => theta1,
            Joint::Theta4 => theta4,
        };
        *angle = to(*angle);
        self.aim_joints(angles);
        Ok(())
    }

    fn change_mode(&mut self, elbows: [Side; 2]) -> Result<(), Refused> {
        let tool = self.tool_end();
        let angles = tool
            .and_then(|tool| self.preview.joints(tool, elbows))
            .ok_or(
                "These elbows hold the tool there only beyond links 2 and 3 in line, or not at \
                 all: move the tool first.",
            )?;
        self.aim_joints(angles);
        Ok(())
    }

    fn aim_joints(&mut self, angles: [f32; 2]) {
        let [to1, to4] = angles;
        let [now1, now4] = self.status.angle;
        self.feeder.aim_at(MoveKind::Joint {
            to: [nearest(to1, now1), nearest(to4, now4)],
            speed: JOINT_SPEED,
        });
    }

    /// Where the tool is when all moves are done [m].
    fn tool_end(&self) -> Option<[f32; 2]> {
        match self.feeder.end() {
            Some(End::Tool(tool)) => Some(tool),
            Some(End::Joints(angles)) => self.preview.tool_at(angles),
            None => self.status.reference,
        }
    }

    /// θ1, θ4 when all moves are done [rad], the working mode being today's.
    fn joints_end(&self) -> Option<[f32; 2]> {
        match self.feeder.end() {
            Some(End::Tool(tool)) => {
                let pose = self.preview.pose(&self.status)?;
                self.preview.joints(tool, self.preview.elbows(&pose))
            }
            Some(End::Joints(angles)) => Some(angles),
            None => Some(self.status.joint_reference?.angle),
        }
    }

    fn load(&mut self, name: &str, text: String) -> Result<(), Refused> {
        self.only_at_rest()?;
        let scenario = Scenario::new(name, self.robot.clone(), name, text);
        match scenario.job() {
            Ok(job) => {
                self.loaded = Some(Loaded {
                    moves: scenario.moves(&job),
                    job,
                    news: JobNews {
                        name: name.into(),
                        ..JobNews::default()
                    },
                });
                self.preview_job();
            }
            Err(error) => {
                self.loaded = None;
                self.pages.tell(&News::Job(&JobNews {
                    name: name.into(),
                    refusal: Some(error.to_string()),
                    ..JobNews::default()
                }));
            }
        }
        Ok(())
    }

    /// Holds the loaded job against what the controller would take from where the tool
    /// stands now, and shows its path.
    pub(super) fn preview_job(&mut self) {
        let Some(Loaded { job, moves, news }) = &mut self.loaded else {
            return;
        };
        *news = self.preview.job(&news.name, job, moves, &self.status);
        self.pages.tell(&News::Job(news));
    }

    /// Begins the job, if all of it can be done from here.
    fn begin(&mut self) -> Result<(), Refused> {
        self.only_at_rest()?;
        if !takes_moves(self.status.state) {
            return Err("The arm is not armed: home it, then arm it.".into());
        }
        self.preview_job();
        let loaded = self.loaded.as_ref().ok_or("There is no job: load one.")?;
        if let Some(why) = &loaded.news.refusal {
            return Err(format!("The job cannot be done. {why}"));
        }
        self.feeder.run(loaded.moves.clone());
        self.notice("The job begins.");
        Ok(())
    }

    /// A long job takes its time to be looked through, in which the host is silent.
    fn only_at_rest(&self) -> Result<(), Refused> {
        match self.rests() {
            true => Ok(()),
            false => Err("The arm moves: wait until it rests, or stop it.".into()),
        }
    }
}

/// A page's number as the controller has it; infinite where it has none so great.
fn single(value: f64) -> f32 {
    value as f32
}
