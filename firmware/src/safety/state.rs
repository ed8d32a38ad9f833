//! The states of the controller and every transition between them.

use serde::{Deserialize, Serialize};

/// What the controller is doing.
///
/// ```
/// use fivebar_firmware::safety::{Event, State};
///
/// // A stopped arm is armed, follows a path, and holds at its end.
/// assert_eq!(State::Stopped.after(Event::Arm), Some(State::Armed));
/// assert_eq!(State::Armed.after(Event::Begin), Some(State::Running));
/// assert_eq!(State::Running.after(Event::Finish), Some(State::Armed));
/// // A latched fault is left only by an explicit clear.
/// assert_eq!(State::Fault.after(Event::Arm), None);
/// assert_eq!(State::Fault.after(Event::Clear), Some(State::Stopped));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum State {
    /// Bridges off, brake on.
    ///
    /// Entry: after power-up, a disarm, a completed homing or a cleared fault.
    /// Exit: to Armed when the arm is homed and inside its envelope; to Homing. The bridges then
    /// wake up for 1.5 ms, before the next state drives them.
    Stopped,
    /// Moving both joints to their switches at limited current.
    ///
    /// Entry: by request from Stopped.
    /// Exit: to Stopped when both switches are found, or, with drives that only power keeps in place, to
    /// Armed; to Stopped by a stop or disarm on the way.
    Homing,
    /// Holding where the arm was when the state was entered.
    ///
    /// Entry: from Stopped by request, from Homing with drives that only power keeps in place, from Running at
    /// the end of the path, from Stopping at rest. Exit: to Running as soon as there is a path; to Stopped by a disarm.
    Armed,
    /// Following the path.
    ///
    /// Entry: from Armed when a segment is queued. Exit: to Armed at the path's end;
    /// to Stopping by a stop; to Stopped, bridges off, by a disarm.
    Running,
    /// Coming to rest on the path.
    ///
    /// Entry: from Running by a stop. Exit: to Armed at rest, the rest of the path
    /// dropped; to Stopped, bridges off, by a disarm.
    Stopping,
    /// A fault is latched: bridges off, or at rest and held, by the fault's response.
    ///
    /// Entry: from everywhere by a fault, with a snapshot of the tick that raised it.
    /// Exit: to Stopped by an explicit clear.
    Fault,
    /// Putting a voltage or a current on one motor of an arm that is not homed.
    ///
    /// Entry: by request from Stopped.
    /// Exit: to Stopped when its time, travel or current is reached and the arm has been slowed
    /// down, or at once, bridges off, by a stop or disarm.
    Exciting,
    /// Crossing a singularity of type 2, from one assembly mode to the other.
    ///
    /// Entry: from Armed by a move. Exit: to Armed at its end; to Stopped, bridges off, by a
    /// disarm. A stop waits for the end, because an arm cannot stop in the singularity.
    Crossing,
    /// Giving way to forces on the arm: a hand leads it.
    ///
    /// Entry: from Armed by a stream in the mode Free. Exit: to Armed, damped and then held, at the stream's end, by a stop, or
    /// without signs of life of the host; to Stopped by a disarm.
    Compliant,
}

/// What can happen in a state. The conditions for arming and for clearing a fault are checked
/// before the event is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Event {
    /// Switch the bridges on and hold the arm.
    Arm,
    /// Switch the bridges off.
    Disarm,
    /// Search for the home switches.
    Home,
    /// Both switches were found.
    Homed,
    /// There is a path to follow.
    Begin,
    /// The path has been followed to its end; or another motion has ended, after which the arm is as before.
    Finish,
    /// Come to rest on the path.
    Stop,
    /// The arm has come to rest.
    Rest,
    /// A fault was raised.
    Fault,
    /// Leave the fault.
    Clear,
    /// Put a voltage or a current on one motor.
    Excite,
    /// Cross a singularity.
    Cross,
    /// Give way to forces on the arm.
    Yield,
}

impl State {
    /// All states.
    pub const ALL: [Self; 9] = [
        Self::Stopped,
        Self::Homing,
        Self::Armed,
        Self::Running,
        Self::Stopping,
        Self::Fault,
        Self::Exciting,
        Self::Crossing,
        Self::Compliant,
    ];

    /// Whether the arm follows paths, or begins to when it gets one.
    #[inline]
    pub(crate) const fn follows_paths(self) -> bool {
        match self {
            Self::Armed | Self::Running => true,
            Self::Stopped
            | Self::Homing
            | Self::Exciting
            | Self::Crossing
            | Self::Compliant
            | Self::Stopping
            | Self::Fault => false,
        }
    }

    /// The state after `event`; `None` if this state does not accept the event, and stays.
    #[expect(
        clippy::too_many_lines,
        reason = "a table: one arm for each pair of state and event"
    )]
    #[inline]
    pub const fn after(self, event: Event) -> Option<Self> {
        match (self, event) {
            (Self::Stopped, Event::Arm) => Some(Self::Armed),
            (Self::Stopped, Event::Home) => Some(Self::Homing),
            (Self::Stopped, Event::Excite) => Some(Self::Exciting),
            (Self::Stopped, Event::Disarm | Event::Stop | Event::Clear) => Some(Self::Stopped),
            (
                Self::Stopped,
                Event::Homed
                | Event::Begin
                | Event::Finish
                | Event::Rest
                | Event::Cross
                | Event::Yield,
            ) => None,

            (Self::Homing, Event::Homed | Event::Stop | Event::Disarm) => Some(Self::Stopped),
            (Self::Homing, Event::Finish) => Some(Self::Armed),
            (
                Self::Homing,
                Event::Arm
                | Event::Home
                | Event::Begin
                | Event::Rest
                | Event::Clear
                | Event::Excite
                | Event::Cross
                | Event::Yield,
            ) => None,

            (Self::Exciting, Event::Finish | Event::Stop | Event::Disarm) => Some(Self::Stopped),
            (
                Self::Exciting,
                Event::Arm
                | Event::Home
                | Event::Homed
                | Event::Begin
                | Event::Rest
                | Event::Clear
                | Event::Excite
                | Event::Cross
                | Event::Yield,
            ) => None,

            (Self::Armed, Event::Begin) => Some(Self::Running),
            (Self::Armed, Event::Cross) => Some(Self::Crossing),
            (Self::Armed, Event::Yield) => Some(Self::Compliant),
            (Self::Armed, Event::Disarm) => Some(Self::Stopped),
            (Self::Armed, Event::Arm | Event::Stop) => Some(Self::Armed),
            (
                Self::Armed,
                Event::Home
                | Event::Homed
                | Event::Finish
                | Event::Rest
                | Event::Clear
                | Event::Excite,
            ) => None,

            (Self::Running, Event::Finish) => Some(Self::Armed),
            (Self::Running, Event::Stop) => Some(Self::Stopping),
            (Self::Running, Event::Disarm) => Some(Self::Stopped),
            (Self::Running, Event::Arm | Event::Begin) => Some(Self::Running),
            (
                Self::Running,
                Event::Home
                | Event::Homed
                | Event::Rest
                | Event::Clear
                | Event::Excite
                | Event::Cross
                | Event::Yield,
            ) => None,

            (Self::Stopping, Event::Rest) => Some(Self::Armed),
            (Self::Stopping, Event::Disarm) => Some(Self::Stopped),
            (Self::Stopping, Event::Stop) => Some(Self::Stopping),
            (
                Self::Stopping,
                Event::Arm
                | Event::Home
                | Event::Homed
                | Event::Begin
                | Event::Finish
                | Event::Clear
                | Event::Excite
                | Event::Cross
                | Event::Yield,
            ) => None,

            (Self::Crossing, Event::Finish) => Some(Self::Armed),
            (Self::Crossing, Event::Disarm) => Some(Self::Stopped),
            (Self::Crossing, Event::Stop | Event::Arm) => Some(Self::Crossing),
            (
                Self::Crossing,
                Event::Home
                | Event::Homed
                | Event::Begin
                | Event::Rest
                | Event::Clear
                | Event::Excite
                | Event::Cross
                | Event::Yield,
            ) => None,

            (Self::Compliant, Event::Rest) => Some(Self::Armed),
            (Self::Compliant, Event::Disarm) => Some(Self::Stopped),
            (Self::Compliant, Event::Stop | Event::Arm) => Some(Self::Compliant),
            (
                Self::Compliant,
                Event::Home
                | Event::Homed
                | Event::Begin
                | Event::Finish
                | Event::Clear
                | Event::Excite
                | Event::Cross
                | Event::Yield,
            ) => None,

            (Self::Fault, Event::Clear) => Some(Self::Stopped),
            (
                Self::Fault,
                Event::Arm
                | Event::Disarm
                | Event::Home
                | Event::Homed
                | Event::Begin
                | Event::Finish
                | Event::Stop
                | Event::Rest
                | Event::Excite
                | Event::Cross
                | Event::Yield,
            ) => None,

            (
                Self::Stopped
                | Self::Homing
                | Self::Armed
                | Self::Running
                | Self::Stopping
                | Self::Fault
                | Self::Exciting
                | Self::Crossing
                | Self::Compliant,
                Event::Fault,
            ) => Some(Self::Fault),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Event::{
        Arm, Begin, Clear, Cross, Disarm, Excite, Finish, Home, Homed, Rest, Stop, Yield,
    };
    use super::State::{
        Armed, Compliant, Crossing, Exciting, Fault, Homing, Running, Stopped, Stopping,
    };
    use super::{Event, State};

    const EVENTS: [Event; 13] = [
        Arm,
        Disarm,
        Home,
        Homed,
        Begin,
        Finish,
        Stop,
        Rest,
        Event::Fault,
        Clear,
        Excite,
        Cross,
        Yield,
    ];

    /// Row by state, column by event; `None` if the event is not accepted.
    const TABLE: [[Option<State>; 13]; 9] = {
        const S: Option<State> = Some(Stopped);
        const H: Option<State> = Some(Homing);
        const A: Option<State> = Some(Armed);
        const R: Option<State> = Some(Running);
        const P: Option<State> = Some(Stopping);
        const F: Option<State> = Some(Fault);
        const X: Option<State> = Some(Exciting);
        const C: Option<State> = Some(Crossing);
        const Y: Option<State> = Some(Compliant);
        const N: Option<State> = None;
        [
            //  Arm Disarm Home Homed Begin Finish Stop Rest Fault Clear Excite Cross Yield
            [A, S, H, N, N, N, S, N, F, S, X, N, N], // Stopped
            [N, S, N, S, N, A, S, N, F, N, N, N, N], // Homing
            [A, S, N, N, R, N, A, N, F, N, N, C, Y], // Armed
            [R, S, N, N, R, A, P, N, F, N, N, N, N], // Running
            [N, S, N, N, N, N, P, A, F, N, N, N, N], // Stopping
            [N, N, N, N, N, N, N, N, F, S, N, N, N], // Fault
            [N, S, N, N, N, S, S, N, F, N, N, N, N], // Exciting
            [C, S, N, N, N, A, C, N, F, N, N, N, N], // Crossing
            [Y, S, N, N, N, N, Y, A, F, N, N, N, N], // Compliant
        ]
    };

    #[test]
    fn every_state_responds_to_every_event_as_the_table_says() {
        for (state, row) in State::ALL.into_iter().zip(TABLE) {
            for (event, expected) in EVENTS.into_iter().zip(row) {
                assert_eq!(state.after(event), expected, "{state:?} after {event:?}");
            }
        }
    }

    #[test]
    fn a_fault_is_left_only_to_stopped_and_only_by_a_clear() {
        for event in EVENTS {
            match Fault.after(event) {
                Some(Stopped) => assert_eq!(event, Clear),
                Some(Fault) => assert_eq!(event, Event::Fault),
                Some(other) => panic!("{event:?} leads from Fault to {other:?}"),
                None => {}
            }
        }
    }

    #[test]
    fn motion_begins_only_from_armed() {
        for state in State::ALL {
            for event in EVENTS {
                if state.after(event) == Some(Running) {
                    assert!(matches!(state, Armed | Running));
                }
            }
        }
    }

    /// Whether events lead from one state to the other.
    fn leads(from: State, to: State) -> bool {
        let mut reached = State::ALL.map(|state| state == from);
        for _ in State::ALL {
            for (index, state) in State::ALL.into_iter().enumerate() {
                for after in EVENTS.into_iter().filter_map(|event| state.after(event)) {
                    let next = State::ALL.iter().position(|&other| other == after);
                    reached[next.unwrap()] |= reached[index];
                }
            }
        }
        State::ALL
            .into_iter()
            .zip(reached)
            .any(|(state, reached)| state == to && reached)
    }

    #[test]
    fn every_state_is_reached_from_stopped_and_leads_back_to_it() {
        for state in State::ALL {
            assert!(leads(Stopped, state), "{state:?} is never reached");
            assert!(leads(state, Stopped), "{state:?} is a trap");
        }
    }

    /// From each state by one event that a host can give: a disarm, or clearing the fault.
    #[test]
    fn a_host_leads_every_state_to_stopped_by_one_event() {
        for state in State::ALL {
            let event = if state == Fault { Clear } else { Disarm };
            assert_eq!(state.after(event), Some(Stopped), "{state:?}");
        }
    }
}
