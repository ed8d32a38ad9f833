//! Driving a job on a controller with motors: settings, homing, streaming, stopping.

mod controlled;
mod error;
mod job;
mod stream;
mod touch;

use crate::link::LinkError;
use crate::measured_pose::measured_pose;
use crate::safe_exit;
use fivebar_files::job::Pause;
use fivebar_firmware::drives::can::BusSetup;
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::protocol::{CommandError, HostCommand, Reply, SectionKey};
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::{BoardLimits, CheckedSettings, ToolOutputSettings};
use fivebar_firmware::{Move, Planner, Request, Settings, Status};

pub use controlled::Controlled;
pub use error::DriveError;
pub use job::job_moves;
pub use stream::{Given, held_angles};
pub use touch::LED_PERIOD;

/// Number of reads after which homing has failed: 60 s.
const LONGEST_HOMING: u32 = 6000;
/// Number of reads for which a path may wait to begin, or to be taken: 10 s.
const LONGEST_STANDSTILL: u32 = 1000;
/// Number of reads after which the wait for the arm's stop ends: 5 s.
const LONGEST_STOP: u32 = 500;

/// How the joint angles become known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Homing {
    /// The controller finds them by its settings' method, unless it knows them.
    IfUnknown,
    /// The controller finds them by its settings' method, also if it knows them.
    Always,
    /// The user has turned the joints to these angles θ1, θ4 by hand [rad]. They take the place of those that the controller
    /// knows.
    At([f32; 2]),
}

/// Drives jobs on a controller with motors.
pub struct Drive<'a, C> {
    controller: &'a mut C,
    wants_stop: &'a dyn Fn() -> bool,
}

impl<'a, C: Controlled> Drive<'a, C> {
    /// Drives this controller. Homing and jobs stop as soon as `wants_stop` returns true.
    pub fn new(controller: &'a mut C, wants_stop: &'a dyn Fn() -> bool) -> Self {
        Self {
            controller,
            wants_stop,
        }
    }

    /// Makes sure that the controller uses these settings. A pen's heights that a program tried, and that ended before it
    /// took them back, give way to those of the settings.
    ///
    /// # Errors
    /// The sections that differ.
    pub fn compare_settings(&mut self, settings: &Settings) -> Result<(), DriveError> {
        let mut theirs = *settings;
        self.controller.client().read_settings(&mut theirs)?;
        if differ_by_heights(settings, &theirs)
            && self.controller.client().write_settings(settings)?.is_ok()
        {
            return Ok(());
        }
        let differing: Vec<_> = SectionKey::ALL
            .into_iter()
            .filter(|key| key.of(settings) != key.of(&theirs))
            .collect();
        match differing.is_empty() {
            true => Ok(()),
            false => Err(DriveError::OtherSettings(differing)),
        }
    }

    /// Sends settings to the controller, which uses and stores them.
    ///
    /// # Errors
    /// A setting that is refused, or that the board refuses.
    pub fn store_settings(&mut self, settings: &Settings) -> Result<(), DriveError> {
        self.controller
            .client()
            .write_settings(settings)?
            .map_err(|error| {
                let limits = match BusSetup::of(settings) {
                    Some(_) => BoardLimits::STM32F405_CAN,
                    None => BoardLimits::STM32F405,
                };
                match limits.check(settings) {
                    Err(bound) if error == CommandError::Settings => DriveError::Settings(bound),
                    _ => DriveError::refused("use the settings", error),
                }
            })?;
        self.command("store the settings", HostCommand::SaveSettings)
    }

    /// Clears a latched fault, if there is one.
    ///
    /// # Errors
    /// The controller refuses, for example because the arm still moves.
    pub fn clear_fault(&mut self) -> Result<(), DriveError> {
        if self.controller.client().status()?.0.fault.is_none() {
            return Ok(());
        }
        self.request(Request::ClearFault)?;
        // A fault that holds the arm ends when the holding brakes have engaged.
        for _ in 0..LONGEST_STOP {
            if self.controller.client().status()?.0.fault.is_none() {
                return Ok(());
            }
            self.controller.pass_time()?;
        }
        Ok(())
    }

    /// Makes the joint angles known. An arm whose drives only power keeps in place is armed afterwards, and rests.
    ///
    /// # Errors
    /// A latched fault, a refusal, or switches that are not found.
    pub fn home(&mut self, homing: Homing) -> Result<(), DriveError> {
        let status = self.fault_free_status()?;
        match homing {
            Homing::IfUnknown if status.homed => return Ok(()),
            Homing::At(angles) => self.request(Request::SetAngles(angles))?,
            Homing::Always if status.state != State::Stopped => {
                self.switch_off()?;
                self.request(Request::Home)?;
            }
            Homing::IfUnknown | Homing::Always => self.request(Request::Home)?,
        }
        for _ in 0..LONGEST_HOMING {
            let status = self.fault_free_status()?;
            if status.homed && matches!(status.state, State::Stopped | State::Armed) {
                return Ok(());
            }
            if (self.wants_stop)() {
                self.bring_to_rest()?;
                return Err(DriveError::Stopped(None));
            }
            self.controller.pass_time()?;
        }
        self.bring_to_rest()?;
        Err(DriveError::NeverHomed)
    }

    /// The tool of the homed arm [m].
    ///
    /// # Errors
    /// A latched fault, or an arm whose place is not known.
    pub fn tool(&mut self) -> Result<[f32; 2], DriveError> {
        self.fault_free_status()?.tool.ok_or(DriveError::NoTool)
    }

    /// Whether the joint angles are known.
    ///
    /// # Errors
    /// A failed connection.
    pub fn is_homed(&mut self) -> Result<bool, DriveError> {
        Ok(self.controller.client().status()?.0.homed)
    }

    /// A planner like the controller's, in the arm's present working and assembly mode.
    ///
    /// # Errors
    /// A latched fault, an arm whose place is not known, or settings that are not valid.
    pub fn planner(&mut self, settings: &Settings) -> Result<Planner, DriveError> {
        let settings = settings.check().map_err(DriveError::Settings)?;
        planner_at(&settings, &self.fault_free_status()?)
    }

    /// Arms, does the moves and disarms.
    ///
    /// All moves are checked, from the tool's position on, before anything moves.
    /// `progress` is called about a hundred times a second with the number of moves that
    /// the controller has accepted and its status. In the end, also after an error, the arm
    /// rests and its bridges are off.
    ///
    /// # Errors
    /// A move that cannot be done, a fault, a stop by the user, an arm that never begins, a failed connection.
    pub fn follow(
        &mut self,
        moves: &[Move],
        settings: &Settings,
        progress: &mut dyn FnMut(usize, &Status),
    ) -> Result<(), DriveError> {
        self.follow_with_pauses(moves, &[], settings, progress, &mut |_| Ok(true))
    }

    /// As [`Self::follow`], and the arm rests at each pause until `goes_on` returns true, which is asked
    /// about a hundred times a second.
    ///
    /// # Errors
    /// As [`Self::follow`], and what `goes_on` refuses.
    pub fn follow_with_pauses(
        &mut self,
        moves: &[Move],
        pauses: &[Pause],
        settings: &Settings,
        progress: &mut dyn FnMut(usize, &Status),
        goes_on: &mut dyn FnMut(&Pause) -> Result<bool, DriveError>,
    ) -> Result<(), DriveError> {
        if let Err(error) = self.check(moves, settings) {
            self.end_hold()?;
            return Err(error);
        }
        self.request(Request::Arm)?;
        let outcome = self.follow_armed(moves, pauses, progress, goes_on);
        // With a latched fault the controller refuses to disarm; `outcome` then holds the fault.
        let disarmed = self.request(Request::Disarm);
        if disarmed.is_err()
            && safe_exit::ends_by_emergency_stop(&self.controller.client().status()?.0)
        {
            self.request(Request::EmergencyStop)?;
        }
        outcome.and(disarmed)
    }

    /// As [`Self::follow_with_pauses`], of moves that are checked, with an arm that is armed and stays so.
    ///
    /// # Errors
    /// The same.
    pub fn follow_armed(
        &mut self,
        moves: &[Move],
        pauses: &[Pause],
        progress: &mut dyn FnMut(usize, &Status),
        goes_on: &mut dyn FnMut(&Pause) -> Result<bool, DriveError>,
    ) -> Result<(), DriveError> {
        let mut outcome = Ok(());
        let mut taken = 0;
        for pause in pauses {
            outcome = outcome
                .and_then(|()| self.stream(&moves[..pause.before], taken, progress))
                .and_then(|()| self.wait_at(pause, progress, goes_on));
            taken = pause.before;
        }
        let outcome = outcome.and_then(|()| self.stream(moves, taken, progress));
        if outcome.is_err() {
            self.bring_to_rest()?;
        }
        outcome
    }

    /// Checks all moves from where the tool is.
    fn check(&mut self, moves: &[Move], settings: &Settings) -> Result<(), DriveError> {
        let (tool, joints) = (self.tool()?, self.controller.client().status()?.0.angle);
        Ok(self
            .planner(settings)?
            .check_all_from(tool, Some(joints), moves)?)
    }

    /// Holds the arm at rest until the job goes on.
    fn wait_at(
        &mut self,
        pause: &Pause,
        progress: &mut dyn FnMut(usize, &Status),
        goes_on: &mut dyn FnMut(&Pause) -> Result<bool, DriveError>,
    ) -> Result<(), DriveError> {
        while !goes_on(pause)? {
            let status = self.fault_free_status()?;
            progress(pause.before, &status);
            if (self.wants_stop)() {
                return Err(DriveError::Stopped(status.tag));
            }
            self.controller.pass_time()?;
        }
        Ok(())
    }

    /// Does the moves from the index `taken` on.
    fn stream(
        &mut self,
        moves: &[Move],
        mut taken: usize,
        progress: &mut dyn FnMut(usize, &Status),
    ) -> Result<(), DriveError> {
        let (_, all_free) = self.controller.client().status()?;
        let mut idle_since = None;
        let mut standstill = 0;
        loop {
            let (status, free) = self.controller.client().status()?;
            progress(taken, &status);
            check_fault(&status)?;
            if (self.wants_stop)() {
                return Err(DriveError::Stopped(status.tag));
            }
            taken += match self.offer(moves.get(taken..).unwrap_or(&[])) {
                Err(DriveError::Move(refusal)) => {
                    // A fault since the last status is the reason why moves are refused.
                    self.fault_free_status()?;
                    return Err(refusal.into());
                }
                offered => offered?,
            };
            // Between two ticks the queue may be empty while its last segment has not begun.
            let is_idle = status.state == State::Armed && free == all_free;
            idle_since = idle_since.filter(|_| is_idle && taken == moves.len());
            match idle_since {
                Some(tick) if status.tick != tick => return Ok(()),
                Some(_) => {}
                None if taken == moves.len() => idle_since = Some(status.tick),
                None => {}
            }
            standstill = if safe_exit::moves(&status) {
                0
            } else {
                standstill + 1
            };
            if standstill > LONGEST_STANDSTILL {
                return Err(DriveError::NeverDone(status.state));
            }
            self.controller.pass_time()?;
        }
    }

    /// Offers moves until the queue is full; returns how many were accepted.
    fn offer(&mut self, moves: &[Move]) -> Result<usize, DriveError> {
        for (taken, next) in moves.iter().enumerate() {
            match self.controller.client().call(HostCommand::Move(*next))? {
                Reply::Taken { .. } => {}
                Reply::Refused(CommandError::Move(error)) if error.kind == MoveErrorKind::Full => {
                    return Ok(taken);
                }
                Reply::Refused(CommandError::Move(error)) => return Err(error.into()),
                reply => return Err(DriveError::UnexpectedReply(format!("{reply:?}"))),
            }
        }
        Ok(moves.len())
    }

    /// Switches an arm off that is armed and rests, such as one that homing has left so.
    ///
    /// # Errors
    /// A failed connection.
    pub fn end_hold(&mut self) -> Result<(), DriveError> {
        match self.controller.client().status()?.0.state {
            State::Armed => self.switch_off(),
            _ => Ok(()),
        }
    }

    /// Arms, and waits until the motors hold the arm.
    ///
    /// # Errors
    /// The controller refuses, a fault, or a failed connection.
    pub fn switch_on(&mut self) -> Result<(), DriveError> {
        self.request(Request::Arm)?;
        self.wait_for(State::Armed)
    }

    /// Switches the bridges off, and waits until they are.
    ///
    /// # Errors
    /// As [`Self::switch_on`].
    pub fn switch_off(&mut self) -> Result<(), DriveError> {
        self.request(Request::Disarm)?;
        self.wait_for(State::Stopped)
    }

    fn wait_for(&mut self, state: State) -> Result<(), DriveError> {
        for _ in 0..LONGEST_STOP {
            if self.fault_free_status()?.state == state {
                break;
            }
            self.controller.pass_time()?;
        }
        Ok(())
    }

    /// Stops on the path and waits for rest.
    fn bring_to_rest(&mut self) -> Result<(), LinkError> {
        // Refused if a fault is latched: then the controller itself brings the arm to rest.
        let _ = self
            .controller
            .client()
            .command(HostCommand::Request(Request::Stop))?;
        for _ in 0..LONGEST_STOP {
            if !safe_exit::moves(&self.controller.client().status()?.0) {
                break;
            }
            self.controller.pass_time()?;
        }
        Ok(())
    }

    /// The status of a controller without a fault.
    ///
    /// # Errors
    /// The fault, if one is latched, or a failed connection.
    pub fn fault_free_status(&mut self) -> Result<Status, DriveError> {
        let (status, _) = self.controller.client().status()?;
        check_fault(&status)?;
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
            Request::Excite(_) => "put a voltage or a current on a motor",
        };
        self.command(what, HostCommand::Request(request))
    }

    fn command(&mut self, what: &'static str, command: HostCommand) -> Result<(), DriveError> {
        self.controller
            .client()
            .command(command)?
            .map_err(|error| DriveError::refused(what, error))
    }
}

/// A planner like that of a controller with this status, in the arm's present working and assembly mode.
///
/// # Errors
/// An arm whose place is not known.
pub fn planner_at(settings: &CheckedSettings, status: &Status) -> Result<Planner, DriveError> {
    let tool = settings.tool();
    let pose = measured_pose(tool, status).ok_or(DriveError::NoTool)?;
    Ok(Planner::new(settings)
        .in_mode(tool.working_mode(&pose))
        .in_assembly(pose.assembly()))
}

fn check_fault(status: &Status) -> Result<(), DriveError> {
    status
        .fault
        .map_or(Ok(()), |fault| Err(DriveError::Fault(fault)))
}

/// Whether settings differ by the heights of a pen on a servo, and by nothing else.
fn differ_by_heights(settings: &Settings, theirs: &Settings) -> bool {
    use ToolOutputSettings::Servo;
    let mut with_heights = *theirs;
    if let (
        Servo {
            up_width,
            down_width,
            ..
        },
        Servo {
            up_width: up,
            down_width: down,
            ..
        },
    ) = (&mut with_heights.tool_output, settings.tool_output)
    {
        [*up_width, *down_width] = [up, down];
    }
    theirs != settings && with_heights == *settings
}

#[cfg(test)]
mod tests {
    use super::{Controlled, Drive, DriveError, Homing};
    use crate::clock::Clock;
    use crate::controller::{Connection, ControllerSource, Session, open};
    use crate::link::{Client, LinkError};
    use fivebar_files::robot::Robot;
    use fivebar_firmware::safety::State;
    use fivebar_firmware::{Move, MoveKind, Request};

    /// Somebody else disarms the arm as soon as it is armed.
    struct Disarmed(Session);

    impl Controlled for Disarmed {
        type Line = Box<dyn Connection>;

        fn client(&mut self) -> &mut Client<Self::Line> {
            &mut self.0.client
        }

        fn pass_time(&mut self) -> Result<(), LinkError> {
            self.0.read_status()?;
            if self.0.status.state == State::Armed {
                assert_eq!(self.0.request(Request::Disarm)?, Ok(()));
            }
            self.0.pass_time()
        }
    }

    #[test]
    fn an_arm_that_never_does_its_moves_ends_with_the_state_in_which_it_is() {
        let robot = Robot::load("benchtop").unwrap();
        let opened = open(&robot, ControllerSource::Simulated, &Clock::simulated());
        let (session, _) = opened.unwrap();
        let settings = *session.settings;
        let mut arm = Disarmed(session);
        let mut drive = Drive::new(&mut arm, &|| false);
        let home = robot.home.map(|angle| angle as f32);
        drive.home(Homing::At(home)).unwrap();
        let [x, y] = drive.tool().unwrap();
        let kind = MoveKind::Line {
            to: [x + 0.01, y],
            feed: 0.1,
        };
        let (tag, tool) = (1, 0);
        let line = Move { tag, tool, kind };
        let ended = drive.follow(&[line], &settings, &mut |_, _| ());
        assert!(
            matches!(ended, Err(DriveError::NeverDone(State::Stopped))),
            "{ended:?}"
        );
    }
}
