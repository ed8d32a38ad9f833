//! Turns the requests of pages into host commands, targets and jobs, or into a refusal.

use super::command_error::sentence;
use super::controller_thread::{ControllerThread, LoadedJob};
use super::lease::PageId;
use super::message::{
    ClientRequest, ControllerRequest, DrivenJoint, JobMessage, PageEvent, ServerMessage,
};
use super::move_feeder::{MoveEnd, takes_moves};
use super::preview::nearest;
use crate::input::scenario::Scenario;
use crate::run::link::LinkError;
use fivebar_firmware::MoveKind;
use fivebar_firmware::protocol::HostCommand;
use fivebar_kinematics::five_bar::Side;
use std::time::Instant;

/// Speed of joint moves, as a share of the joints' greatest speed.
const JOINT_SPEED: f32 = 0.4;

/// Why a request is refused, as a sentence.
type Refused = String;

impl ControllerThread {
    /// Handles an event of a page.
    pub(super) fn handle_event(&mut self, page: PageId, event: PageEvent) -> Result<(), LinkError> {
        let now = Instant::now();
        match event {
            PageEvent::Joined => {
                // After a page is lost, a moving arm comes to rest before another page may
                // get control without asking.
                if self.rests() && !self.lease.is_alive(now) {
                    self.lease.acquire(page, now, false);
                    self.feeder.clear();
                }
                self.resend();
            }
            PageEvent::Lagged => self.resend(),
            PageEvent::Left => {
                if self.lease.release(page) {
                    self.feeder.clear();
                }
            }
            PageEvent::Malformed(error) => self.refuse(
                Some(page),
                format!("The server does not know this request; load the page again ({error})."),
            ),
            PageEvent::Request(request) => {
                let in_control = self.lease.renew(page, now);
                if let Err(why) = self.handle_request(page, in_control, request)? {
                    self.refuse(Some(page), why);
                }
            }
        }
        Ok(())
    }

    /// Sends fault and job again, for a page that is new or has missed messages.
    fn resend(&mut self) {
        self.sent_fault = None;
        if let Some(loaded) = &self.loaded {
            self.pages.send(&ServerMessage::Job(&loaded.message));
        }
    }

    fn handle_request(
        &mut self,
        page: PageId,
        in_control: bool,
        request: ClientRequest,
    ) -> Result<Result<(), Refused>, LinkError> {
        Ok(match request {
            ClientRequest::Alive => Ok(()),
            ClientRequest::Control => self.give_control(page),
            ClientRequest::Request(wanted) if in_control || wanted.is_open_to_all() => {
                return self.request(wanted);
            }
            _ if !in_control => Err("This page watches: take control first.".into()),
            ClientRequest::Request(wanted) => return self.request(wanted),
            _ if self.feeder.is_running() => Err("A job is running: stop it first.".into()),
            ClientRequest::Load { name, text } => self.load_job(&name, text),
            ClientRequest::Run => self.run_job(),
            _ if !takes_moves(self.status.state) => {
                Err("The arm is not armed: home it, then arm it.".into())
            }
            ClientRequest::Jog(by) => self.jog(by.map(single)),
            ClientRequest::Follow(to) => {
                self.move_tool(to.map(single));
                Ok(())
            }
            ClientRequest::JogJoint { joint, by } => {
                self.move_joint(joint, |angle| angle + single(by))
            }
            ClientRequest::Turn { joint, to } => self.move_joint(joint, |_| single(to)),
            ClientRequest::Mode(elbows) => self.change_mode(elbows),
        })
    }

    fn give_control(&mut self, page: PageId) -> Result<(), Refused> {
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
        let answer = self.client.command(HostCommand::Request(wanted.into()))?;
        Ok(answer.map_err(|refusal| sentence(&refusal)))
    }

    fn jog(&mut self, [dx, dy]: [f32; 2]) -> Result<(), Refused> {
        let [x, y] = self
            .tool_end()
            .ok_or("The arm is not armed: home it, then arm it.")?;
        self.move_tool([x + dx, y + dy]);
        Ok(())
    }

    fn move_tool(&mut self, to: [f32; 2]) {
        let feed = self.settings.motion.max_speed;
        self.feeder.set_target(MoveKind::Line { to, feed });
    }

    /// Turns one joint, from the angles at which the next move begins; the other stays.
    fn move_joint(
        &mut self,
        joint: DrivenJoint,
        to: impl FnOnce(f32) -> f32,
    ) -> Result<(), Refused> {
        let mut angles = self
            .joints_end()
            .ok_or("The arm is not armed: home it, then arm it.")?;
        let [theta1, theta4] = &mut angles;
        let angle = match joint {
            DrivenJoint::Theta1 => theta1,
            DrivenJoint::Theta4 => theta4,
        };
        *angle = to(*angle);
        self.move_joints(angles);
        Ok(())
    }

    fn change_mode(&mut self, elbows: [Side; 2]) -> Result<(), Refused> {
        let tool = self.tool_end();
        let angles = tool
            .and_then(|tool| self.preview.joints(tool, elbows))
            .ok_or(
                "With these elbows the tool cannot be at this position on the present assembly \
                 mode: move the tool first.",
            )?;
        self.move_joints(angles);
        Ok(())
    }

    fn move_joints(&mut self, angles: [f32; 2]) {
        let [to1, to4] = angles;
        let [now1, now4] = self.status.angle;
        self.feeder.set_target(MoveKind::Joint {
            to: [nearest(to1, now1), nearest(to4, now4)],
            speed: JOINT_SPEED,
        });
    }

    /// The position of the tool after all pending moves [m].
    fn tool_end(&self) -> Option<[f32; 2]> {
        match self.feeder.end() {
            Some(MoveEnd::Tool(tool)) => Some(tool),
            Some(MoveEnd::Joints(angles)) => self.preview.tool_at(angles),
            None => self.status.reference,
        }
    }

    /// θ1, θ4 after all pending moves [rad], in the present working mode.
    fn joints_end(&self) -> Option<[f32; 2]> {
        match self.feeder.end() {
            Some(MoveEnd::Tool(tool)) => {
                let pose = self.preview.pose(&self.status)?;
                self.preview.joints(tool, self.preview.elbows(&pose))
            }
            Some(MoveEnd::Joints(angles)) => Some(angles),
            None => Some(self.status.joint_reference?.angle),
        }
    }

    fn load_job(&mut self, name: &str, text: String) -> Result<(), Refused> {
        self.require_rest()?;
        let scenario = Scenario::new(name, self.robot.clone(), name, text);
        match scenario.job() {
            Ok(job) => {
                self.loaded = Some(LoadedJob {
                    moves: scenario.moves(&job),
                    job,
                    message: JobMessage {
                        name: name.into(),
                        ..JobMessage::default()
                    },
                });
                self.preview_job();
            }
            Err(error) => {
                self.loaded = None;
                self.pages.send(&ServerMessage::Job(&JobMessage {
                    name: name.into(),
                    refusal: Some(error.to_string()),
                    ..JobMessage::default()
                }));
            }
        }
        Ok(())
    }

    /// Checks the loaded job from the tool's present position, as the controller would, and
    /// sends its path to the pages.
    pub(super) fn preview_job(&mut self) {
        let Some(LoadedJob {
            job,
            moves,
            message,
        }) = &mut self.loaded
        else {
            return;
        };
        *message = self.preview.job(&message.name, job, moves, &self.status);
        self.pages.send(&ServerMessage::Job(message));
    }

    /// Starts the job, if all of it can be done from the tool's present position.
    fn run_job(&mut self) -> Result<(), Refused> {
        self.require_rest()?;
        if !takes_moves(self.status.state) {
            return Err("The arm is not armed: home it, then arm it.".into());
        }
        self.preview_job();
        let loaded = self.loaded.as_ref().ok_or("There is no job: load one.")?;
        if let Some(why) = &loaded.message.refusal {
            return Err(format!("The job cannot be done. {why}"));
        }
        self.feeder.run(loaded.moves.clone());
        self.notice("The job has started.");
        Ok(())
    }

    /// Refuses while the arm moves: checking a long job takes time, and the host sends
    /// nothing meanwhile.
    fn require_rest(&self) -> Result<(), Refused> {
        match self.rests() {
            true => Ok(()),
            false => Err("The arm is moving: stop it or wait until it rests.".into()),
        }
    }
}

/// A page's number in the controller's precision; infinite if it is too large.
fn single(value: f64) -> f32 {
    value as f32
}
