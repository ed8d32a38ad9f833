//! What must have happened before power and motion, and in which order. It is known from the host's
//! commands and the arm's samples alone, so a mistake of the controller does not hide itself.

use super::view::moves;
use fivebar_firmware::controller::Request;
use fivebar_firmware::protocol::HostCommand;
use fivebar_firmware::safety::{Event, Fault, Response, State};
use fivebar_firmware::{ActuatorCommand, SensorSample, Status};

/// Every event of the table of states.
pub(super) const EVENTS: [Event; 13] = [
    Event::Arm,
    Event::Disarm,
    Event::Home,
    Event::Homed,
    Event::Begin,
    Event::Finish,
    Event::Stop,
    Event::Rest,
    Event::Fault,
    Event::Clear,
    Event::Excite,
    Event::Cross,
    Event::Yield,
];

/// What an exploration remembers of the commands and ticks so far.
#[derive(Clone, Debug)]
pub(super) struct History {
    /// Ticks in a row in which the bridges have been on.
    powered_for: u32,
    /// Ticks that the bridges take to wake up.
    wake_up: u32,
    /// Moves accepted since the path was last dropped.
    moves: u32,
    path_generation: u32,
    state: State,
    fault: Option<Fault>,
    /// The fault was latched where the arm could be held, and holds it.
    is_held: bool,
    homed: bool,
    /// The reference moved after the last tick or command.
    is_moving: bool,
}

/// A rule, and what was found.
pub(super) type Broken = (&'static str, String);

impl History {
    pub(super) fn new(wake_up: u32) -> Self {
        Self {
            powered_for: 0,
            wake_up,
            moves: 0,
            path_generation: 0,
            state: State::Stopped,
            fault: None,
            is_held: false,
            homed: false,
            is_moving: false,
        }
    }

    /// The host's command was executed.
    pub(super) fn accepted(&mut self, command: &HostCommand, after: &Status) -> Result<(), Broken> {
        let breaks = |rule, is_kept| self.breaks(command, after, rule, is_kept);
        match command {
            HostCommand::Request(request) => self.requested(request, command, after),
            HostCommand::BeginStream(_) => {
                breaks(
                    "a stream begins only where the arm is held",
                    matches!(after.state, State::Armed | State::Compliant),
                )?;
                self.moves += 1;
                self.step(after, false)
            }
            HostCommand::Move(_) => {
                breaks(
                    "a move is accepted only where paths are followed",
                    matches!(after.state, State::Armed | State::Running | State::Crossing),
                )?;
                self.moves += 1;
                self.step(after, false)
            }
            HostCommand::ApplySettings => {
                breaks(
                    "settings are applied only while stopped",
                    self.state == State::Stopped,
                )?;
                *self = Self::new(self.wake_up);
                self.step(after, false)
            }
            HostCommand::SaveSettings => breaks(
                "settings are saved only while stopped",
                self.state == State::Stopped,
            ),
            _ => breaks(
                "no other command changes the state, the fault or the angles' origin",
                (after.state, after.fault, after.homed) == (self.state, self.fault, self.homed),
            ),
        }
    }

    /// A request was executed.
    fn requested(
        &mut self,
        request: &Request,
        command: &HostCommand,
        after: &Status,
    ) -> Result<(), Broken> {
        use Request::{Arm, ClearFault, Disarm, EmergencyStop, Excite, Home, SetAngles, Stop};
        let latched = self.fault;
        let breaks = |rule, is_kept| self.breaks(command, after, rule, is_kept);
        match request {
            Arm | Home | Excite(_) | Disarm | Stop | SetAngles(_) => breaks(
                "under a latched fault only clearing it is accepted",
                latched.is_none(),
            )?,
            EmergencyStop => self.emergency_stopped(after)?,
            ClearFault => {}
        }
        match request {
            Disarm | ClearFault => {
                breaks(
                    "disarming and clearing a fault lead to Stopped",
                    after.state == State::Stopped,
                )?;
                breaks(
                    "a fault is cleared only when the arm rests",
                    latched.is_none() || !self.is_moving,
                )?;
            }
            Stop => breaks(
                "a stop ends a path, a search and an excitation",
                !matches!(
                    after.state,
                    State::Running | State::Homing | State::Exciting
                ),
            )?,
            SetAngles(_) => breaks(
                "angles are declared only while stopped",
                self.state == State::Stopped,
            )?,
            Excite(_) => breaks("a homed arm is not excited", !after.homed)?,
            Home => breaks(
                "an arm that is to be homed does not count as homed",
                !after.homed,
            )?,
            Arm | EmergencyStop => {}
        }
        // A crossing ends before the arm stops.
        if matches!(request, Stop | Disarm) && after.state != State::Crossing {
            self.moves = 0;
        }
        let gives_angles = matches!(request, SetAngles(_));
        self.step(after, gives_angles)
    }

    fn breaks(
        &self,
        command: &HostCommand,
        after: &Status,
        rule: &'static str,
        is_kept: bool,
    ) -> Result<(), Broken> {
        if is_kept {
            return Ok(());
        }
        let found = format!("{command:?} in {:?} led to {:?}", self.state, after.state);
        Err((rule, found))
    }

    /// An emergency stop was requested, whatever the number of its command: its fault is latched, or
    /// one that had switched the power off before.
    pub(super) fn emergency_stopped(&self, after: &Status) -> Result<(), Broken> {
        // A controlled stop needs a path or a position to hold: a power-off fault follows it.
        let was_off = self.fault.is_some() && !self.is_held;
        let latched = match after.fault {
            Some(Fault::EmergencyStop) => true,
            fault => was_off && fault == self.fault,
        };
        if after.state == State::Fault && latched {
            return Ok(());
        }
        let found = format!("{:?}, {:?} in {:?}", after.state, after.fault, self.state);
        Err(("an emergency stop latches in every state", found))
    }

    /// The path generation that the controller reports.
    pub(super) fn path_is(&mut self, generation: u32) {
        if self.path_generation != generation {
            self.path_generation = generation;
            self.moves = 0;
        }
    }

    /// The outcome of a tick.
    pub(super) fn ticked(
        &mut self,
        sample: &SensorSample,
        command: &ActuatorCommand,
        after: &Status,
    ) -> Result<(), Broken> {
        let powered = command.enable == [true; 2];
        let drives = command.drives.duty != [0.0; 2] || !command.brake;
        if powered && drives && self.powered_for < self.wake_up {
            let found = format!("driven after {} ticks", self.powered_for);
            return Err(("bridges are driven only when they are awake", found));
        }
        self.powered_for = if powered { self.powered_for + 1 } else { 0 };
        if sample.emergency_stop {
            self.emergency_stopped(after)?;
            if powered {
                let found = format!("{:?}", after.state);
                return Err(("a pressed emergency stop switches off", found));
            }
        }
        let follows = matches!(after.state, State::Running | State::Crossing);
        if follows && self.moves == 0 {
            let found = format!("{:?} without one", after.state);
            return Err((
                "the arm moves along a path only for a move accepted since the path was dropped",
                found,
            ));
        }
        self.step(after, false)
    }

    /// A change of the state, the fault or the origin of the angles.
    pub(super) fn step(&mut self, after: &Status, gives_angles: bool) -> Result<(), Broken> {
        let (before, now) = (self.state, after.state);
        let found = || format!("{before:?}, then {now:?} with {:?}", after.fault);
        let is_in_table = EVENTS.iter().any(|&event| before.after(event) == Some(now));
        if before != now && !is_in_table {
            return Err(("the state changes by the table of states", found()));
        }
        let interrupted =
            before == State::Crossing && !matches!(now, State::Crossing | State::Armed);
        if interrupted && after.homed {
            return Err((
                "an arm whose crossing was interrupted does not count as homed",
                found(),
            ));
        }
        let loses = matches!(
            after.fault,
            Some(Fault::EncoderJump | Fault::EncoderDisagreement | Fault::AssemblyMode)
        );
        if loses && self.fault != after.fault && after.homed {
            let rule = "a fault of the angles leaves the arm not homed";
            return Err((rule, found()));
        }
        self.is_moving = moves(after);
        if after.homed && !self.homed && !gives_angles && before != State::Homing {
            return Err(("angles become known by homing or by the host", found()));
        }
        if self.fault != after.fault {
            let follows = matches!(
                before,
                State::Armed | State::Running | State::Stopping | State::Compliant
            );
            let holds = |fault: Fault| fault.response() == Response::ControlledStop;
            self.is_held = follows && after.fault.is_some_and(holds);
        }
        (self.state, self.fault, self.homed) = (now, after.fault, after.homed);
        Ok(())
    }
}
