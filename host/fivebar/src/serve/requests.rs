//! Turns the requests of pages into host commands, targets and jobs, or into a refusal.

use super::controller_thread::ControllerThread;
use super::held_motion::HeldBy;
use super::job_thread::{JobSource, Work};
use super::move_feeder::{MoveEnd, takes_moves};
use super::preview::nearest;
use super::teaching::Teaching;
use super::wire::channels::{Event, EventKind};
use super::wire::lease::{Page, PageId};
use super::wire::message::{
    ClientRequest, ControllerRequest, DrivenJoint, PenPosition, ServerMessage,
};
use super::wire::numbered::NumberedRequest;
use super::wire::stop_signal::Stop;
use crate::senders::Endpoints;
use fivebar_firmware::safety::State;
use fivebar_firmware::{MoveKind, Request};
use fivebar_kinematics::five_bar::Side;
use fivebar_sim::link::LinkError;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Speed of joint moves, as a share of the joints' greatest speed.
pub(super) const JOINT_SPEED: f32 = 0.4;

/// After a fault is cleared the bridges stay off for this time, so that quick clicks, or messages,
/// that clear it do not go on to move the arm.
const PAUSE: Duration = Duration::from_secs(1);

/// Why a request is refused, as a sentence.
pub(super) type Refused = String;

/// What became of an event.
struct Handled {
    outcome: Result<(), Refused>,
    /// The controller was asked.
    has_asked: bool,
    /// A stop came after it, which says enough to its page.
    is_dropped: bool,
}

impl Handled {
    fn by(outcome: Result<(), Refused>) -> Self {
        Self {
            outcome,
            has_asked: false,
            is_dropped: false,
        }
    }

    fn dropped() -> Self {
        Self {
            is_dropped: true,
            ..Self::by(Err("A stop was asked for after it.".into()))
        }
    }
}

impl ClientRequest {
    fn is_stop(&self) -> bool {
        matches!(self, Self::Request(wanted) if wanted.kind().is_ok())
    }

    /// Whether a stop cancels the request if it still waits.
    fn ends_with_a_stop(&self) -> bool {
        match self {
            Self::Alive
            | Self::Control
            | Self::Load { .. }
            | Self::Read(_)
            | Self::Place(_)
            | Self::Fit
            | Self::LineAt(_)
            | Self::RunOn(_)
            | Self::Feed(_) => false,
            Self::Request(_)
            | Self::Jog(_)
            | Self::Follow(_)
            | Self::JogJoint { .. }
            | Self::Turn { .. }
            | Self::Hold(_)
            | Self::HoldJoint { .. }
            | Self::Renew(_)
            | Self::Pen(_)
            | Self::Teach(_)
            | Self::PenHeight { .. }
            | Self::KeepPen
            | Self::Macro(_)
            | Self::Mode(_)
            | Self::Console(_)
            | Self::Frame
            | Self::Run
            | Self::RunFrom(_)
            | Self::Resume => true,
        }
    }
}

impl ControllerThread {
    /// Handles an event of a page, and answers a request that has a number. What a page asked for before it was lost is
    /// dropped, and so is what could move the arm and was asked for before the last stop. Returns whether the
    /// controller was asked.
    pub(super) fn handle_event(&mut self, event: &Event) -> Result<bool, LinkError> {
        let page = Arc::clone(&event.page);
        if !page.is_connected() {
            return Ok(false);
        }
        let number = match &event.kind {
            EventKind::Request(numbered) => numbered.number,
            EventKind::Joined | EventKind::LongMessage(_) => None,
        };
        let Handled {
            outcome,
            has_asked,
            is_dropped,
        } = self.handle(event)?;
        if let Some(number) = number {
            self.answer(page.id, number, outcome.clone().err())?;
        }
        if let Err(why) = outcome
            && !is_dropped
        {
            self.refuse(Some(page.id), why);
        }
        Ok(has_asked)
    }

    fn handle(&mut self, event: &Event) -> Result<Handled, LinkError> {
        let now = self.session.clock.now();
        let page = Arc::clone(&event.page);
        let lease = &self.pages.shared.lease;
        let in_control = lease.is_held_by(page.id, now);
        let outcome = match &event.kind {
            EventKind::Joined => {
                // After a page is lost, a moving arm comes to rest before another page may
                // get control without asking, unless its job runs on.
                if (self.rests() || self.runs_on()) && !lease.is_alive(now) {
                    lease.acquire(&page, event.received, now, false);
                }
                let endpoints = self.senders.endpoints();
                if let Some(warning) = endpoints.and_then(Endpoints::warning) {
                    self.refuse(Some(page.id), warning);
                }
                Ok(())
            }
            // A job moves nothing, and a page is silent while it sends a large one: its lease may
            // have run out.
            EventKind::LongMessage(message) if lease.holder() == Some(page.id) => {
                self.load_job(page.id, JobSource::Message(message.clone()))
            }
            EventKind::LongMessage(_) => Err("This page watches: take control first.".into()),
            EventKind::Request(NumberedRequest { number, request }) => {
                if let ClientRequest::Renew(number) = request {
                    self.renew_held_motion(event, *number);
                    return Ok(Handled::by(Ok(())));
                }
                // The answer to a stop comes when it is done.
                if request.is_stop() {
                    self.stop_if_asked()?;
                    return Ok(Handled::by(Ok(())));
                }
                if event.stops < self.pages.shared.stop.count() && request.ends_with_a_stop() {
                    return Ok(Handled::dropped());
                }
                let excludes_senders = match request {
                    ClientRequest::Alive | ClientRequest::Console(_) => false,
                    ClientRequest::Control => true,
                    _ => in_control,
                };
                if excludes_senders && let Err(why) = self.take_control_from_senders() {
                    return Ok(Handled::by(Err(why)));
                }
                if let ClientRequest::Request(wanted) = request
                    && in_control
                {
                    let outcome = self.request(&page, *wanted)?;
                    return Ok(Handled {
                        has_asked: true,
                        ..Handled::by(outcome)
                    });
                }
                if in_control && let Some(outcome) = self.try_pen(page.id, request)? {
                    return Ok(Handled {
                        has_asked: true,
                        ..Handled::by(outcome)
                    });
                }
                let held_by = HeldBy::new(event, *number);
                self.handle_request(&page, event.received, in_control, request.clone(), held_by)
            }
        };
        Ok(Handled::by(outcome))
    }

    /// Answers a request. States of later ticks show what it did.
    fn answer(
        &mut self,
        to: PageId,
        number: u64,
        refused: Option<Refused>,
    ) -> Result<(), LinkError> {
        // Samples that have arrived by now are older.
        self.take_samples()?;
        self.updates.send(&ServerMessage::Answer {
            to,
            number,
            tick: Some(self.session.status.tick),
            refused,
        });
        Ok(())
    }

    fn handle_request(
        &mut self,
        page: &Page,
        received: Instant,
        in_control: bool,
        request: ClientRequest,
        held_by: HeldBy,
    ) -> Result<(), Refused> {
        match request {
            // `handle` has done the renewals.
            ClientRequest::Alive | ClientRequest::Renew(_) => Ok(()),
            ClientRequest::Control => self.give_control(page, received),
            _ if !in_control => Err("This page watches: take control first.".into()),
            // `handle` has asked the controller.
            ClientRequest::Request(_)
            | ClientRequest::PenHeight { .. }
            | ClientRequest::KeepPen => Ok(()),
            ClientRequest::Console(line) => self.send_to_console(page.id, line),
            ClientRequest::RunOn(on) => {
                self.run_on = on;
                Ok(())
            }
            ClientRequest::Feed(share) if self.jobs.is_time_optimal && share > 1.0 => Err(
                "The job is as fast as the arm's torque allows: choose 100 % of its speed or less."
                    .into(),
            ),
            ClientRequest::Feed(share) => {
                self.feeder.set_feed(single(share));
                Ok(())
            }
            ClientRequest::Teach(false) => self.teach(page.id, false),
            _ if self.teaching.is_some() => Err("A hand leads the arm: end that first.".into()),
            _ if self.feeder.is_running() => Err("A job is running: stop it first.".into()),
            ClientRequest::Load { name, text } => {
                self.load_job(page.id, JobSource::Text(name, text))
            }
            ClientRequest::Place(shift) => self.place_job(|job| Work::Place(job, shift)),
            ClientRequest::Read(reading) => self.read_again(reading),
            ClientRequest::Fit => self.place_job(Work::Fit),
            ClientRequest::Frame => self.go_around(),
            ClientRequest::LineAt(point) => self.look_for_line(page, point),
            ClientRequest::Macro(name) => self.do_macro(page, &name),
            ClientRequest::Run => self.run_job(page, 0),
            ClientRequest::RunFrom(line) => self.run_job(page, line),
            ClientRequest::Resume => self.resume_job(page),
            _ if self.session.status.state == State::Crossing => {
                Err("The arm crosses a singularity: wait until it rests.".into())
            }
            _ if !takes_moves(self.session.status.state) => {
                Err("The arm is not armed: home it, then arm it.".into())
            }
            _ if self.run_asked_by.is_some() => {
                Err("The job is being checked: wait, or stop.".into())
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
            ClientRequest::Hold(velocity) => self.hold(velocity.map(single), held_by),
            ClientRequest::HoldJoint { joint, rate } => {
                self.hold_joint(joint, single(rate), held_by)
            }
            ClientRequest::Pen(position) => self.move_pen(position),
            ClientRequest::Teach(_) => self.teach(page.id, true),
            ClientRequest::Mode(elbows) => {
                self.change_mode(page.id, elbows);
                Ok(())
            }
        }
    }

    /// Lets a hand lead the arm, or holds it.
    fn teach(&mut self, page: PageId, begins: bool) -> Result<(), Refused> {
        if !begins {
            let teaching = self.teaching.as_mut().ok_or("No hand leads the arm.")?;
            return teaching.end(&mut self.session);
        }
        self.is_ready()?;
        let branch = self.preview.start(&self.session.status).branch;
        let branch = branch.ok_or("The arm is not homed: home it first.")?;
        self.teaching = Some(Teaching::begin(&mut self.session, page, branch.assembly)?);
        self.feeder.drop_target();
        self.notice("Lead the tip by hand. The same button ends it.");
        Ok(())
    }

    fn give_control(&mut self, page: &Page, received: Instant) -> Result<(), Refused> {
        let lease = &self.pages.shared.lease;
        let before = lease.holder();
        if !lease.acquire(page, received, self.session.clock.now(), self.rests()) {
            return Err(
                "Another page is in control of a moving arm: stop the arm, then take control."
                    .into(),
            );
        }
        if before != Some(page.id) && !self.rests() && !self.runs_on() {
            // The path of the lost page is not this page's.
            self.pages.shared.stop.raise(Stop::OnPath, page.id);
        }
        if before.is_some_and(|before| before != page.id) {
            self.refuse(before, "Another page has taken control.".into());
        }
        Ok(())
    }

    fn request(
        &mut self,
        page: &Page,
        wanted: ControllerRequest,
    ) -> Result<Result<(), Refused>, LinkError> {
        let request: Request = match wanted.kind() {
            Err(request) => request,
            // The web server does not queue stops.
            Ok(stop) => {
                self.pages.shared.stop.raise(stop, page.id);
                return Ok(Ok(()));
            }
        };
        let powers = matches!(request, Request::Arm | Request::Home);
        let clock = &self.session.clock;
        if powers && self.cleared.is_some_and(|at| clock.since(at) < PAUSE) {
            return Ok(Err(
                "A fault was cleared a moment ago: look at the arm, wait a second, then ask again."
                    .into(),
            ));
        }
        if powers && let Err(why) = self.end_pen_trial()? {
            return Ok(Err(why));
        }
        let answer = self.session.request(request)?;
        if request == Request::ClearFault && answer.is_ok() {
            self.cleared = Some(self.session.clock.now());
        }
        Ok(answer)
    }

    /// Puts the pen down or lifts it. A tool with power, such as a laser, works along strokes only.
    fn move_pen(&mut self, position: PenPosition) -> Result<(), Refused> {
        if !self.session.settings.tool_output.waits() {
            return Err(
                "The arm has no pen: its tool is none, or works along strokes only.".into(),
            );
        }
        if !self.rests() || !self.feeder.has_no_target() {
            return Err("The arm is moving: stop it or wait until it rests.".into());
        }
        self.feeder.set_pen(position == PenPosition::Down);
        Ok(())
    }

    fn jog(&mut self, [dx, dy]: [f32; 2]) -> Result<(), Refused> {
        let [x, y] = self.end_of_tool()?;
        self.move_tool([x + dx, y + dy]);
        Ok(())
    }

    fn move_tool(&mut self, to: [f32; 2]) {
        let feed = self.session.settings.motion.max_speed;
        self.feeder.set_target(MoveKind::Line { to, feed });
    }

    /// Turns one joint, from the angles at which the next move begins; the other stays.
    fn move_joint(
        &mut self,
        joint: DrivenJoint,
        to: impl FnOnce(f32) -> f32,
    ) -> Result<(), Refused> {
        let mut angles = self.end_of_joints()?;
        let [theta1, theta4] = &mut angles;
        let angle = match joint {
            DrivenJoint::Theta1 => theta1,
            DrivenJoint::Theta4 => theta4,
        };
        *angle = to(*angle);
        self.move_joints(angles);
        Ok(())
    }

    /// Remembers the working mode that a page wants until the arm rests and its path is planned.
    fn change_mode(&mut self, page: PageId, elbows: [Side; 2]) {
        self.mode_wanted = Some((page, elbows));
    }

    /// Has the paths to other working modes planned where the arm rests, and goes the one that a page
    /// wants.
    pub(super) fn change_mode_if_wanted(&mut self) {
        let status = &self.session.status;
        let rests = status.state == State::Armed && self.feeder.has_no_target();
        let pose = self
            .preview
            .start(status)
            .branch
            .zip(status.joint_reference);
        let pose = pose.filter(|_| rests && !self.feeder.is_running());
        self.modes
            .look(pose.map(|(branch, joints)| (joints.angle, branch)));
        let Some((page, elbows)) = self.mode_wanted else {
            return;
        };
        if !takes_moves(self.session.status.state) || self.feeder.is_running() {
            self.mode_wanted = None;
            return;
        }
        match self.modes.path(elbows) {
            None => return,
            Some(Ok(corners)) => {
                let speed = JOINT_SPEED;
                let moves = corners.into_iter();
                self.feeder
                    .set_way(moves.map(|to| MoveKind::Joint { to, speed }));
            }
            Some(Err(why)) => self.refuse(Some(page), why),
        }
        self.mode_wanted = None;
    }

    fn move_joints(&mut self, angles: [f32; 2]) {
        let [to1, to4] = angles;
        let [now1, now4] = self.session.status.angle;
        self.feeder.set_target(MoveKind::Joint {
            to: [nearest(to1, now1), nearest(to4, now4)],
            speed: JOINT_SPEED,
        });
    }

    /// As [`Self::tool_end`], or why there is none.
    pub(super) fn end_of_tool(&self) -> Result<[f32; 2], Refused> {
        let end = self.tool_end();
        end.ok_or_else(|| "The arm is not armed: home it, then arm it.".into())
    }

    /// As [`Self::joints_end`], or why there are none.
    pub(super) fn end_of_joints(&self) -> Result<[f32; 2], Refused> {
        let end = self.joints_end();
        end.ok_or_else(|| "The arm is not armed: home it, then arm it.".into())
    }

    /// The position of the tool after all pending moves [m].
    fn tool_end(&self) -> Option<[f32; 2]> {
        match self.feeder.end() {
            Some(MoveEnd::Tool(tool)) => Some(tool),
            Some(MoveEnd::Joints(angles)) => {
                let pose = self.preview.pose(&self.session.status)?;
                self.preview.tool_at(angles, pose.assembly())
            }
            None => self.session.status.reference,
        }
    }

    /// θ1, θ4 after all pending moves [rad], in the present working mode.
    fn joints_end(&self) -> Option<[f32; 2]> {
        match self.feeder.end() {
            Some(MoveEnd::Tool(tool)) => {
                let pose = self.preview.pose(&self.session.status)?;
                self.preview.joints(tool, self.preview.branch(&pose))
            }
            Some(MoveEnd::Joints(angles)) => Some(angles),
            None => Some(self.session.status.joint_reference?.angle),
        }
    }
}

/// A page's number in the controller's precision; infinite if it is too large.
pub(super) fn single(value: f64) -> f32 {
    value as f32
}
