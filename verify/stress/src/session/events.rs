//! The events of a session: what the host does, and what happens to the arm.

use super::{POLL, Session};
use crate::arm::plant;
use crate::limits::Followed;
use crate::orders::Event;
use crate::rules::Violation;
use crate::stream::StreamRun;
use crate::timed::TimedRun;
use fivebar_firmware::protocol::HostCommand;
use fivebar_firmware::safety::State;
use fivebar_firmware::{CrossingMove, FULL_TOOL, Move, MoveKind, Planner, Request};
use fivebar_kinematics::five_bar::Joint;

/// Ticks after which a move is offered again.
const AGAIN: u16 = 20;

impl Session<'_> {
    /// Carries out an event.
    pub(super) fn event(&mut self, event: Event) -> Result<(), Violation> {
        match event {
            Event::Command(command) => self.command(command),
            Event::Move(kind) => {
                // Up, down, and between.
                let tool = [0, FULL_TOOL, 20_000][self.kinds.len() % 3];
                self.send_move(tool, kind)?;
                self.timed_end = None;
                Ok(())
            }
            Event::Timed(run) => self.timed_run(&run),
            Event::Stream(run) => self.stream(&run),
            Event::Crossing(plan) => self.crossing(plan),
            Event::Recover => self.recover(),
            Event::Repair => {
                self.plant = plant(self.flags);
                self.is_sound = true;
                Ok(())
            }
            Event::DeclareAngles => self.declare_angles(),
            Event::Repeat => {
                let frame = self.last_frame.clone();
                self.receive(&frame)
            }
            Event::Skip(by) => {
                self.next.0 = self.next.0.wrapping_add(u16::from(by));
                Ok(())
            }
            Event::Garbage(bytes) => self.receive(&bytes),
            Event::Corrupt(place) => {
                self.corrupt = Some(place);
                Ok(())
            }
            Event::Wait(ticks) => self.wait(ticks, true),
            Event::Silence(ticks) => self.wait(ticks, false),
            Event::Hostile(hostile, ticks) => {
                self.hostile = Some((hostile, 0, u32::from(ticks % 16) + 1));
                self.wait(u16::from(ticks), true)
            }
            Event::Fault(kind) => {
                self.plant.inject(kind);
                self.is_sound = false;
                Ok(())
            }
            Event::Planner(every) => {
                self.planner_every = u32::from(every);
                Ok(())
            }
        }
    }

    fn recover(&mut self) -> Result<(), Violation> {
        self.command(HostCommand::Request(Request::ClearFault))?;
        self.declare_angles()?;
        self.command(HostCommand::Request(Request::Arm))
    }

    /// Sends a crossing from its beginning. What happens next in the session happens during it.
    fn crossing(&mut self, plan: CrossingMove) -> Result<(), Violation> {
        self.command(HostCommand::Request(Request::Disarm))?;
        self.plant = plant(self.flags);
        self.is_sound = true;
        // The counts of another arm are a jump.
        self.wait(2, true)?;
        self.recover()?;
        self.wait(AGAIN, true)?;
        let state = self.controller.state();
        let accepted = self.send_move(0, MoveKind::Crossing(plan))?;
        self.timed_end = None;
        if state == State::Armed && accepted {
            self.report.crossings += 1;
        }
        Ok(())
    }

    pub(super) fn declare_angles(&mut self) -> Result<(), Violation> {
        let angles = Joint::ALL.map(|joint| self.plant.angle(joint) as f32);
        self.command(HostCommand::Request(Request::SetAngles(angles)))
    }

    pub(super) fn wait(&mut self, ticks: u16, polls: bool) -> Result<(), Violation> {
        for tick in 0..u32::from(ticks) {
            if polls && tick % POLL == POLL - 1 {
                self.command(HostCommand::Status)?;
            }
            self.tick()?;
        }
        Ok(())
    }

    /// Sends a move. Returns whether it was taken; in the second run, whether it was in the first.
    fn send_move(&mut self, tool: u16, kind: MoveKind) -> Result<bool, Violation> {
        let tag = self.kinds.len() as u32;
        self.kinds.push(match kind {
            MoveKind::Line { .. } | MoveKind::Arc { .. } => Followed::Path,
            MoveKind::Timed(_) | MoveKind::Crossing(_) => Followed::Timed,
            MoveKind::Dwell { .. } => Followed::Dwell,
            MoveKind::Joint { .. } => Followed::Joint,
        });
        let number = self.refusals.len();
        self.command(HostCommand::Move(Move { tag, tool, kind }))?;
        let refused = |refusals: &Vec<bool>| refusals.get(number) == Some(&true);
        Ok(!(refused(&self.refusals) || self.replace.as_ref().is_some_and(refused)))
    }

    /// Streams set-points from where the arm is.
    fn stream(&mut self, run: &StreamRun) -> Result<(), Violation> {
        let status = self.controller.status();
        let joints = status.joint_reference.map_or(status.angle, |it| it.angle);
        let (begun, tool) = (status.tick, self.tool());
        self.timed_end = None;
        if run.wall.is_some() {
            let (place, fixture) = (0, run.wall);
            self.command(HostCommand::SetFixture { place, fixture })?;
        }
        self.command(HostCommand::BeginStream(*run.config()))?;
        for n in 0..run.points {
            if let Some(point) = run.point(n, begun, tool, joints) {
                self.point(n, &point)?;
            }
            self.wait(StreamRun::period(), false)?;
        }
        if run.ends {
            self.command(HostCommand::EndStream)?;
        }
        Ok(())
    }

    /// Sends a run of timed moves from where the arm comes to rest, or where the last run ends.
    fn timed_run(&mut self, run: &TimedRun) -> Result<(), Violation> {
        let mut patience = run.patience;
        let rests = |session: &Self| match session.controller.state() {
            State::Running => false,
            State::Armed => !session.planner_is_current() || session.planner.is_empty(),
            _ => true,
        };
        while patience > 0 && !rests(self) {
            patience = patience.saturating_sub(AGAIN);
            self.wait(AGAIN, true)?;
        }
        let end = self.timed_end.filter(|_| !rests(self));
        let start = end.unwrap_or_else(|| self.tool());
        let follows = |session: &Self| {
            let state = session.controller.state();
            matches!(state, State::Armed | State::Running)
        };
        // The session's own planner may have a working mode of which a refused move has told it.
        let settings = self.controller.settings().check();
        let planner = Planner::new(&settings.expect("settings in use are valid"));
        let pieces = run.pieces(start, &planner);
        for piece in pieces.into_iter().take(run.sent) {
            while !self.send_move(run.tool, MoveKind::Timed(piece))? {
                if patience == 0 || rests(self) || !follows(self) {
                    return Ok(());
                }
                patience = patience.saturating_sub(AGAIN);
                self.wait(AGAIN, true)?;
            }
            self.timed_end = Some(piece.end());
            self.wait(run.between, true)?;
        }
        Ok(())
    }
}
