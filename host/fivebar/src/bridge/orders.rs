//! What each order of a line does.

use super::protocol::{Order, Refusal};
use super::slot::{Phase, SenderSlot};
use fivebar_firmware::safety::State;
use fivebar_firmware::{Move, Request, Status};
use fivebar_sim::controller::Session;
use fivebar_sim::link::LinkError;
use fivebar_sim::simulation::fault_name;

/// Grbl's number for a target out of reach.
const OUT_OF_REACH: u8 = 15;
/// Moves that wait for the controller while further lines are answered.
const WAITING: usize = 16;

/// How far an order is done.
pub(super) enum Progress {
    Done,
    /// It has begun, and this is left of it.
    Begun(Order),
    Waits,
    Refused(Refusal),
}

impl SenderSlot<'_> {
    pub(super) fn execute(
        &mut self,
        session: &mut Session,
        order: Order,
    ) -> Result<Progress, LinkError> {
        match order {
            Order::Moves(moves) => self.add(session, &moves, false),
            Order::Jog(moves) => self.add(session, &moves, true),
            Order::Accepted
                if self.phase == Phase::Ready && self.path.queue.waiting() < WAITING =>
            {
                Ok(Progress::Done)
            }
            Order::Finish if self.rests() => Ok(Progress::Done),
            Order::Pause if self.rests() => {
                self.phase = Phase::Held;
                Ok(Progress::Begun(Order::Resumed))
            }
            Order::Resumed if self.phase == Phase::Ready => Ok(Progress::Done),
            Order::Home => self.home(session),
            Order::Homed => self.homed(session),
            Order::Unlock => {
                let Some(fault) = session.status.fault else {
                    return Ok(Progress::Done);
                };
                let left = self
                    .fault
                    .clears_from
                    .saturating_duration_since(session.clock.now());
                if !left.is_zero() {
                    let why = format!(
                        "{} is latched: wait {:.1} s, then clear it",
                        fault_name(fault),
                        left.as_secs_f64()
                    );
                    return Ok(Progress::Refused(Refusal::locked(why)));
                }
                self.locked_until(session, Request::ClearFault)
            }
            Order::Disarm if session.status.state == State::Armed => {
                self.locked_until(session, Request::Disarm)
            }
            Order::Disarm => Ok(Progress::Done),
            Order::Accepted | Order::Finish | Order::Pause | Order::Resumed => Ok(Progress::Waits),
        }
    }

    /// Whether the arm rests at the end of its path.
    fn rests(&self) -> bool {
        self.phase == Phase::Ready && self.path.queue.is_empty()
    }

    /// Adds moves to the path, if the controller will accept all of them. The first one arms.
    fn add(
        &mut self,
        session: &mut Session,
        moves: &[Move],
        is_jog: bool,
    ) -> Result<Progress, LinkError> {
        if self.phase != Phase::Ready || self.path.queue.waiting() >= WAITING {
            return Ok(Progress::Waits);
        }
        if let Some(refusal) = latched(&session.status) {
            return Ok(Progress::Refused(refusal));
        }
        let mut from = self.path.queue.end();
        if from.is_none() {
            from = session.status.reference.or(session.status.tool);
        }
        let Some(mut from) = from else {
            let why = "the joint angles are unknown: home first, $H or G28";
            return Ok(Progress::Refused(Refusal::locked(why)));
        };
        for next in moves {
            match self.planner.check(from, next) {
                Ok(end) => from = end,
                Err(error) => {
                    let why = error.to_string();
                    return Ok(Progress::Refused(Refusal::new(OUT_OF_REACH, why)));
                }
            }
        }
        if session.status.state == State::Stopped {
            if let Err(why) = session.request(Request::Arm)? {
                return Ok(Progress::Refused(Refusal::locked(why)));
            }
            session.read_status()?;
        }
        self.path.queue.push(moves);
        self.path.is_jog = is_jog;
        Ok(Progress::Begun(Order::Accepted))
    }

    /// Homes with the bridges off before and after. It clears no fault.
    fn home(&mut self, session: &mut Session) -> Result<Progress, LinkError> {
        if let Some(refusal) = latched(&session.status) {
            return Ok(Progress::Refused(refusal));
        }
        if !self.rests() {
            return Ok(Progress::Waits);
        } else if session.status.state == State::Armed {
            let _ = session.request(Request::Disarm)?;
            session.wait_until_off()?;
        }
        if let Err(why) = session.request(Request::Home)? {
            return Ok(Progress::Refused(Refusal::locked(why)));
        }
        session.read_status()?;
        self.phase = Phase::Homing;
        Ok(Progress::Begun(Order::Homed))
    }

    fn homed(&mut self, session: &mut Session) -> Result<Progress, LinkError> {
        if session.status.state == State::Homing {
            return Ok(Progress::Waits);
        }
        if self.phase != Phase::Homing && !session.status.homed {
            return Ok(Progress::Refused(Refusal::locked("homing was stopped")));
        }
        self.phase = Phase::Ready;
        if session.status.fault.is_some() || !session.status.homed {
            return Ok(Progress::Refused(Refusal::locked("homing has failed")));
        }
        self.drop_path(session);
        Ok(Progress::Done)
    }

    /// A request after which the arm may stand elsewhere, because nothing has held it.
    fn locked_until(
        &mut self,
        session: &mut Session,
        request: Request,
    ) -> Result<Progress, LinkError> {
        if let Err(why) = session.request(request)? {
            return Ok(Progress::Refused(Refusal::locked(why)));
        }
        session.wait_until_off()?;
        self.drop_path(session);
        Ok(Progress::Done)
    }
}

/// Why nothing may move, if a fault is latched.
fn latched(status: &Status) -> Option<Refusal> {
    let fault = fault_name(status.fault?);
    let why = format!("{fault} is latched: $X or M999 clears it");
    Some(Refusal::locked(why))
}
