//! What each order of a line does.

use super::machine::{Machine, Phase};
use super::protocol::{Order, Refusal};
use fivebar_firmware::safety::State;
use fivebar_firmware::{Move, Request};
use fivebar_sim::link::LinkError;
use fivebar_sim::simulation::fault_name;
use std::time::Instant;

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

impl Machine<'_> {
    pub(super) fn execute(&mut self, order: Order) -> Result<Progress, LinkError> {
        match order {
            Order::Moves(moves) => self.add(&moves, false),
            Order::Jog(moves) => self.add(&moves, true),
            Order::Accepted if self.phase == Phase::Ready && self.path.waiting() < WAITING => {
                Ok(Progress::Done)
            }
            Order::Finish if self.rests() => Ok(Progress::Done),
            Order::Pause if self.rests() => {
                self.phase = Phase::Hold { rests: true };
                Ok(Progress::Begun(Order::Resumed))
            }
            Order::Resumed if self.phase == Phase::Ready => Ok(Progress::Done),
            Order::Home => self.home(),
            Order::Homed => self.homed(),
            Order::Unlock => {
                let Some(fault) = self.status.fault else {
                    return Ok(Progress::Done);
                };
                let left = self.clears_from.saturating_duration_since(Instant::now());
                if !left.is_zero() {
                    let why = format!(
                        "{} is latched: wait {:.1} s, then clear it",
                        fault_name(fault),
                        left.as_secs_f64()
                    );
                    return Ok(Progress::Refused(Refusal::locked(why)));
                }
                self.locked_until(Request::ClearFault)
            }
            Order::Disarm if self.status.state == State::Armed => {
                self.locked_until(Request::Disarm)
            }
            Order::Disarm => Ok(Progress::Done),
            Order::Accepted | Order::Finish | Order::Pause | Order::Resumed => Ok(Progress::Waits),
        }
    }

    /// Whether the arm rests at the end of its path.
    fn rests(&self) -> bool {
        self.phase == Phase::Ready && self.path.is_empty()
    }

    /// Adds moves to the path, if the controller will accept all of them. The first one arms.
    fn add(&mut self, moves: &[Move], is_jog: bool) -> Result<Progress, LinkError> {
        if self.phase != Phase::Ready || self.path.waiting() >= WAITING {
            return Ok(Progress::Waits);
        }
        if let Some(refusal) = self.latched() {
            return Ok(Progress::Refused(refusal));
        }
        let mut from = self.path.end();
        if from.is_none() {
            from = self.status.reference.or(self.status.tool);
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
        if self.status.state == State::Stopped {
            if let Err(why) = self.request(Request::Arm)? {
                return Ok(Progress::Refused(Refusal::locked(why)));
            }
            (self.status, _) = self.client.status()?;
        }
        self.path.push(moves);
        self.jogs = is_jog;
        Ok(Progress::Begun(Order::Accepted))
    }

    /// Why nothing may move, if a fault is latched.
    fn latched(&self) -> Option<Refusal> {
        let fault = fault_name(self.status.fault?);
        let why = format!("{fault} is latched: $X or M999 clears it");
        Some(Refusal::locked(why))
    }

    /// Homes with the bridges off before and after. It clears no fault.
    fn home(&mut self) -> Result<Progress, LinkError> {
        if let Some(refusal) = self.latched() {
            return Ok(Progress::Refused(refusal));
        }
        if !self.rests() {
            return Ok(Progress::Waits);
        } else if self.status.state == State::Armed {
            let _ = self.request(Request::Disarm)?;
            self.wait_until_off()?;
        }
        if let Err(why) = self.request(Request::Home)? {
            return Ok(Progress::Refused(Refusal::locked(why)));
        }
        (self.status, _) = self.client.status()?;
        self.phase = Phase::Homing;
        Ok(Progress::Begun(Order::Homed))
    }

    fn homed(&mut self) -> Result<Progress, LinkError> {
        if self.status.state == State::Homing {
            return Ok(Progress::Waits);
        }
        if self.phase != Phase::Homing && !self.status.homed {
            return Ok(Progress::Refused(Refusal::locked("homing was stopped")));
        }
        self.phase = Phase::Ready;
        if self.status.fault.is_some() || !self.status.homed {
            return Ok(Progress::Refused(Refusal::locked("homing has failed")));
        }
        self.drop_path();
        Ok(Progress::Done)
    }

    /// A request after which the arm may stand elsewhere, because nothing has held it.
    fn locked_until(&mut self, request: Request) -> Result<Progress, LinkError> {
        if let Err(why) = self.request(request)? {
            return Ok(Progress::Refused(Refusal::locked(why)));
        }
        self.wait_until_off()?;
        self.drop_path();
        Ok(Progress::Done)
    }
}
