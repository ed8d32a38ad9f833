//! A job done by a controller that drives motors: prepared, streamed, stopped.

mod error;

use crate::run::link::{Conversation, LinkError};
use fivebar_firmware::planner::Reason;
use fivebar_firmware::protocol::{Order, Refusal, Reply, SectionKey};
use fivebar_firmware::safety::State;
use fivebar_firmware::{Move, Planner, Request, Settings, Status};
use std::io::{Read, Write};

pub use error::DriveError;

/// Reads in vain after which homing counts as failed: 60 s.
const LONGEST_HOMING: u32 = 6000;
/// Reads in vain after which a stopping arm counts as not stopping: 5 s.
const LONGEST_STOP: u32 = 500;

/// How the joint angles become known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Homing {
    /// By driving to the home switches.
    Switches,
    /// The arm has been put to these angles θ1, θ4 by hand [rad].
    At([f32; 2]),
}

/// A controller that drives motors, and someone who may want it to stop.
pub struct Drive<'a, L> {
    conversation: &'a mut Conversation<L>,
    wants_stop: &'a dyn Fn() -> bool,
}

impl<'a, L: Read + Write> Drive<'a, L> {
    /// Drives over this conversation until `wants_stop` says otherwise.
    pub fn new(conversation: &'a mut Conversation<L>, wants_stop: &'a dyn Fn() -> bool) -> Self {
        Self {
            conversation,
            wants_stop,
        }
    }

    /// Sees to it that the controller uses these settings: uploads and stores them if it
    /// may, else refuses any others.
    ///
    /// # Errors
    /// The sections that differ, or a refused upload.
    pub fn agree_on(&mut self, settings: &Settings, upload: bool) -> Result<(), DriveError> {
        let mut theirs = *settings;
        self.conversation.read_settings(&mut theirs)?;
        let differing: Vec<_> = SectionKey::ALL
            .into_iter()
            .filter(|key| key.of(settings) != key.of(&theirs))
            .collect();
        if differing.is_empty() && !upload {
            return Ok(());
        }
        if !upload {
            return Err(DriveError::OtherSettings(differing));
        }
        self.conversation
            .write_settings(settings)?
            .map_err(|refusal| DriveError::refused("use the settings", refusal))?;
        self.order("store the settings", Order::SaveSettings)
    }

    /// Leaves a latched fault, if there is one.
    ///
    /// # Errors
    /// The arm still moves, or the fault does not let itself be cleared.
    pub fn clear_fault(&mut self) -> Result<(), DriveError> {
        match self.conversation.status()?.0.fault {
            Some(_) => self.request(Request::ClearFault),
            None => Ok(()),
        }
    }

    /// Makes the joint angles known, if they are not.
    ///
    /// # Errors
    /// A latched fault, a refusal, switches that are not found.
    pub fn home(&mut self, homing: Homing) -> Result<(), DriveError> {
        if self.sound_status()?.homed {
            return Ok(());
        }
        match homing {
            Homing::At(angles) => self.request(Request::SetAngles(angles))?,
            Homing::Switches => self.request(Request::Home)?,
        }
        for _ in 0..LONGEST_HOMING {
            let status = self.sound_status()?;
            if status.homed && status.state == State::Stopped {
                return Ok(());
            }
            if (self.wants_stop)() {
                self.request(Request::Stop)?;
                return Err(DriveError::Stopped(None));
            }
            self.conversation.listen()?;
        }
        self.request(Request::Stop)?;
        Err(DriveError::NeverHomed)
    }

    /// Arms, does the moves and disarms. Everything is checked from where the tool stands
    /// before anything moves. `progress` is told, a hundred times a second or so, how many
    /// moves the controller has taken and what it is doing.
    /// However it ends, the arm is brought to rest and the bridges are off.
    ///
    /// # Errors
    /// A move that cannot be done, a fault, a wish to stop, a line that breaks.
    pub fn follow(
        &mut self,
        moves: &[Move],
        settings: &Settings,
        progress: &mut dyn FnMut(usize, &Status),
    ) -> Result<(), DriveError> {
        let status = self.sound_status()?;
        let planner = Planner::new(settings).map_err(DriveError::Unsound)?;
        let mut tool = status.tool.ok_or(DriveError::NoTool)?;
        for order in moves {
            tool = planner.check(tool, order)?;
        }
        self.request(Request::Arm)?;
        let outcome = self.stream(moves, progress);
        if outcome.is_err() {
            self.bring_to_rest()?;
        }
        // Where a fault is latched the bridges are off or the arm is held: either way it
        // says so, and takes no disarming.
        let disarmed = self.request(Request::Disarm);
        outcome.and(disarmed)
    }

    fn stream(
        &mut self,
        moves: &[Move],
        progress: &mut dyn FnMut(usize, &Status),
    ) -> Result<(), DriveError> {
        let (_, all_room) = self.conversation.status()?;
        let mut taken = 0;
        let mut idle_since = None;
        loop {
            let (status, room) = self.conversation.status()?;
            progress(taken, &status);
            sound(&status)?;
            if (self.wants_stop)() {
                return Err(DriveError::Stopped(status.tag));
            }
            taken += self.offer(moves.get(taken..).unwrap_or(&[]))?;
            // Between two ticks a queue may be empty and its last piece not begun.
            let is_idle = status.state == State::Armed && room == all_room;
            idle_since = idle_since.filter(|_| is_idle && taken == moves.len());
            match idle_since {
                Some(tick) if status.tick != tick => return Ok(()),
                Some(_) => {}
                None if taken == moves.len() => idle_since = Some(status.tick),
                None => {}
            }
            self.conversation.listen()?;
        }
    }

    /// Offers moves until one finds no room; how many were taken.
    fn offer(&mut self, moves: &[Move]) -> Result<usize, DriveError> {
        for (taken, order) in moves.iter().enumerate() {
            match self.conversation.ask(Order::Move(*order))? {
                Reply::Taken { .. } => {}
                Reply::Refused(Refusal::Move(refusal)) if refusal.reason == Reason::Full => {
                    return Ok(taken);
                }
                Reply::Refused(Refusal::Move(refusal)) => return Err(refusal.into()),
                reply => return Err(DriveError::Confused(format!("{reply:?}"))),
            }
        }
        Ok(moves.len())
    }

    /// Stops on the path and waits for rest.
    fn bring_to_rest(&mut self) -> Result<(), LinkError> {
        // Refused where a fault is latched: then it is at rest or comes to it by itself.
        let _ = self.conversation.order(Order::Request(Request::Stop))?;
        for _ in 0..LONGEST_STOP {
            let (status, _) = self.conversation.status()?;
            match status.state {
                State::Running | State::Stopping | State::Homing => self.conversation.listen()?,
                State::Stopped | State::Armed | State::Fault => break,
            }
        }
        Ok(())
    }

    /// The status, unless a fault is latched.
    fn sound_status(&mut self) -> Result<Status, DriveError> {
        let (status, _) = self.conversation.status()?;
        sound(&status)?;
        Ok(status)
    }

    fn request(&mut self, request: Request) -> Result<(), DriveError> {
        let what = match request {
            Request::Arm => "arm",
            Request::Disarm => "disarm",
            Request::Home => "home",
            Request::SetAngles(_) => "take these joint angles",
            Request::Stop => "stop",
            Request::EmergencyStop => "stop at once",
            Request::ClearFault => "clear the fault",
        };
        self.order(what, Order::Request(request))
    }

    fn order(&mut self, what: &'static str, order: Order) -> Result<(), DriveError> {
        self.conversation
            .order(order)?
            .map_err(|refusal| DriveError::refused(what, refusal))
    }
}

fn sound(status: &Status) -> Result<(), DriveError> {
    status
        .fault
        .map_or(Ok(()), |fault| Err(DriveError::Fault(fault)))
}
