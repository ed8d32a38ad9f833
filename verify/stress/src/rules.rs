//! The rules that hold after every tick, whatever the host, the sensors and the arm do.
//!
//! | rule | reason |
//! |---|---|
//! | duties are finite and within ±1, and zero without power | the bridges get nothing else |
//! | both bridges have power, or none has | one motor alone would drag the arm |
//! | without power the brake is engaged | nothing else holds the arm |
//! | the motors drive against the brake only to hold the arm | it would wear out, and hide the torque |
//! | power only after an accepted `Arm` or `Home` | the arm moves only when a host wants it |
//! | without power an arm on open-loop drives is not homed | nothing shows where it is |
//! | no power under a fault that switches it off | it stays off until a host clears the fault |
//! | no power in Stopped, and without known joint angles only while homing | |
//! | a fault stays until it is cleared; only a power-off fault, brakes that fail, or a host that has left for a minute replace another | |
//! | a pressed emergency stop switches the power off in its tick | |
//! | no motion along a path with a host silent for longer than its timeout | |
//! | the tool is off in its tick where no path is followed, after a stop, a fault or silence | nothing marks what the host did not ask for |
//! | the status holds finite numbers | hosts and reports read it |

use fivebar_firmware::controller::JointReference;
use fivebar_firmware::safety::{Fault, Response, State};
use fivebar_firmware::{ActuatorCommand, SensorSample, Status};
use std::fmt;

/// A rule that was broken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// The tick, from 0.
    pub tick: u32,
    /// The rule.
    pub rule: &'static str,
    /// What was found.
    pub found: String,
}

impl Violation {
    pub(crate) fn new(tick: u32, rule: &'static str, found: impl fmt::Display) -> Self {
        Self {
            tick,
            rule,
            found: found.to_string(),
        }
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tick, rule, found } = self;
        write!(f, "tick {tick}: the rule is that {rule}, but {found}")
    }
}

impl std::error::Error for Violation {}

/// What the rules must remember from tick to tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rules {
    /// A host has armed the arm, or homes it, and nothing has ended that.
    pub permitted: bool,
    /// The host has cleared the fault, which ends when the brakes have engaged.
    pub cleared: bool,
    /// The controller is a new one since the last tick.
    pub renewed: bool,
    /// Ticks since the last frame of the host.
    pub silence: u32,
    /// Greatest allowed silence, in ticks.
    pub timeout: u32,
    /// The output with the tool off.
    pub tool_off: u16,
    /// The drives are such as only power keeps in place.
    pub open_loop: bool,
    fault: Option<Fault>,
}

impl Rules {
    /// Rules with this greatest silence of the host, in ticks.
    pub fn with_timeout(timeout: u32) -> Self {
        Self {
            timeout,
            ..Self::default()
        }
    }

    /// Checks the outcome of a tick.
    ///
    /// # Errors
    /// The first rule that is broken.
    pub fn check(
        &mut self,
        tick: u32,
        sample: &SensorSample,
        command: &ActuatorCommand,
        status: &Status,
    ) -> Result<(), Violation> {
        self.silence = self.silence.saturating_add(1);
        Self::check_command(tick, command, status)?;
        self.check_power(tick, sample, command, status)?;
        self.check_state(tick, command, status)?;

        let off = status.fault.is_some_and(|fault| !holds(fault));
        if off || status.state == State::Stopped {
            self.permitted = false;
        }
        self.cleared &= status.fault.is_some() && status.fault == self.fault;
        self.fault = status.fault;
        self.renewed = false;
        Ok(())
    }

    /// The rules of the actuators.
    fn check_command(
        tick: u32,
        command: &ActuatorCommand,
        status: &Status,
    ) -> Result<(), Violation> {
        let [power, other] = command.enable;
        let broken = |rule, found: fmt::Arguments<'_>| Err(Violation::new(tick, rule, found));
        if !command.drives.duty.iter().all(|duty| duty.abs() <= 1.0) {
            return broken(
                "duties are finite and within ±1",
                format_args!("{command:?}"),
            );
        }
        if power != other {
            return broken(
                "both bridges have power or none",
                format_args!("{command:?}"),
            );
        }
        let idle = command.drives.duty == [0.0; 2];
        if !(power || idle && command.brake) {
            return broken(
                "without power duties are 0 and the brake is engaged",
                format_args!("{command:?}"),
            );
        }
        let rests = |reference: JointReference| reference.velocity == [0.0; 2];
        if command.brake && !idle && !status.joint_reference.is_some_and(rests) {
            return broken(
                "the motors drive against the brake only to hold the arm",
                format_args!("{command:?}, {:?}", status.joint_reference),
            );
        }
        Ok(())
    }

    /// The rules of power.
    fn check_power(
        &self,
        tick: u32,
        sample: &SensorSample,
        command: &ActuatorCommand,
        status: &Status,
    ) -> Result<(), Violation> {
        let (state, [power, _]) = (status.state, command.enable);
        let broken = |rule, found: fmt::Arguments<'_>| Err(Violation::new(tick, rule, found));
        if power && !self.permitted {
            return broken(
                "power needs an accepted Arm, Home or Excite",
                format_args!("{state:?}"),
            );
        }
        let may = match state {
            State::Homing
            | State::Exciting
            | State::Crossing
            | State::Compliant
            | State::Armed
            | State::Running
            | State::Stopping => true,
            State::Fault => status.fault.is_some_and(holds),
            State::Stopped => false,
        };
        if power && !may {
            return broken(
                "no power in Stopped or under a power-off fault",
                format_args!("{state:?}, {:?}", status.fault),
            );
        }
        let searches = matches!(state, State::Homing | State::Exciting);
        if power && !(status.homed || searches) {
            return broken(
                "without known angles there is power only while homing and exciting",
                format_args!("{state:?}"),
            );
        }
        if self.open_loop && status.homed && !power {
            return broken(
                "without power an arm on open-loop drives is not homed",
                format_args!("{state:?}, {:?}", status.fault),
            );
        }
        if power && sample.emergency_stop {
            return broken(
                "a pressed emergency stop switches off in its tick",
                format_args!("{state:?}"),
            );
        }
        Ok(())
    }

    /// The rules of the state, its fault, and what it lets the arm do.
    fn check_state(
        &self,
        tick: u32,
        command: &ActuatorCommand,
        status: &Status,
    ) -> Result<(), Violation> {
        let state = status.state;
        let broken = |rule, found: fmt::Arguments<'_>| Err(Violation::new(tick, rule, found));
        if (state == State::Fault) != status.fault.is_some() {
            return broken(
                "a fault is latched in the state Fault and in no other",
                format_args!("{state:?}, {:?}", status.fault),
            );
        }
        self.fault_stays(status)
            .map_err(|found| Violation::new(tick, "a fault stays until it is cleared", found))?;
        let is_led = matches!(state, State::Running | State::Compliant);
        if is_led && self.silence > self.timeout.saturating_add(2) {
            return broken(
                "no path is followed, and no arm gives way, for a silent host",
                format_args!("{} ticks of silence", self.silence),
            );
        }
        let follows = match state {
            State::Armed | State::Running => self.silence <= self.timeout.saturating_add(2),
            State::Stopped
            | State::Homing
            | State::Exciting
            | State::Crossing
            | State::Compliant
            | State::Stopping
            | State::Fault => false,
        };
        if command.tool != self.tool_off && !follows {
            return broken(
                "the tool is off in the tick in which the arm no longer follows its path",
                format_args!("{} in {state:?}", command.tool),
            );
        }
        if let Some(name) = not_finite(status) {
            return broken("the status holds finite numbers", format_args!("{name}"));
        }
        Ok(())
    }

    fn fault_stays(&self, status: &Status) -> Result<(), String> {
        let Some(before) = self.fault else {
            return Ok(());
        };
        let replaced = status.fault.is_some_and(|now| {
            before.response() == Response::ControlledStop
                && (now.response() == Response::PowerOff
                    || now == Fault::BrakeFailed
                    || now == Fault::CommandTimeout && self.silence > self.timeout)
        });
        if status.fault == Some(before) || replaced || self.cleared || self.renewed {
            Ok(())
        } else {
            Err(format!("{before:?} became {:?}", status.fault))
        }
    }
}

/// The name of a value that is no finite number.
fn not_finite(status: &Status) -> Option<&'static str> {
    let finite = |pair: [f32; 2]| pair.iter().all(|value| value.is_finite());
    [
        ("angle", status.angle),
        ("velocity", status.velocity),
        ("torque", status.torque),
        ("current_demand", status.current_demand),
        ("current", status.current),
        ("duty", status.duty),
        ("tool", status.tool.unwrap_or_default()),
        ("reference", status.reference.unwrap_or_default()),
        ("bus_voltage", [status.bus_voltage; 2]),
    ]
    .into_iter()
    .find_map(|(name, pair)| (!finite(pair)).then_some(name))
}

/// Whether the arm is held, or comes to rest on its path, under this fault.
fn holds(fault: Fault) -> bool {
    fault.response() == Response::ControlledStop
}
