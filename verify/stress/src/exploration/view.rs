//! What distinguishes the states of an exploration. All else, such as angles, is left out.

use super::arm::Disturbance;
use fivebar_firmware::controller::PlanningSnapshot;
use fivebar_firmware::planner::StreamPhase;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{ActuatorCommand, Status};
use fivebar_kinematics::five_bar::Side;

/// Speed above which a joint counts as moving [rad/s].
const MOVES: f32 = 0.02;

/// An abstract state: what can be seen of the controller, its planner and its session from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct View {
    pub(super) state: State,
    pub(super) fault: Option<Fault>,
    homed: bool,
    powered: bool,
    brake: bool,
    drives: bool,
    tool_is_on: bool,
    /// The reference moves.
    moves: bool,
    /// While homing: the direction of each joint.
    directions: [i8; 2],
    /// The controller has a path ahead.
    has_path: bool,
    /// Where paths are followed: the planner's queue is empty.
    is_planned: bool,
    is_held: bool,
    /// A stream of set-points has the arm.
    streams: bool,
    /// The arm gives way to a hand, and is not damped.
    yields: bool,
    /// The assembly mode.
    is_left: bool,
    has_settings: bool,
    /// The host is silent for longer than its timeout.
    is_silent: bool,
    pub(super) zeros_are_wrong: bool,
    pub(super) disturbance: Option<Disturbance>,
    /// How long nothing of this has changed.
    age: Age,
}

/// How long a view has lasted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Age {
    /// Up to one tick.
    New,
    /// Some ticks.
    Young,
    /// Longer than the bridges take to wake up.
    Old,
}

/// What is known outside the controller.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outside {
    pub(super) is_planned: bool,
    pub(super) stream: Option<StreamPhase>,
    pub(super) has_settings: bool,
    pub(super) is_silent: bool,
    pub(super) zeros_are_wrong: bool,
    pub(super) disturbance: Option<Disturbance>,
}

impl View {
    pub(super) fn new(
        status: &Status,
        snapshot: &PlanningSnapshot,
        command: &ActuatorCommand,
        outside: Outside,
    ) -> Self {
        let homes = status.state == State::Homing;
        let powered = command.enable == [true; 2];
        let follows = matches!(
            status.state,
            State::Armed | State::Running | State::Compliant
        );
        let direction = |speed: f32| i8::from(speed > MOVES) - i8::from(speed < -MOVES);
        Self {
            state: status.state,
            fault: status.fault,
            homed: status.homed,
            powered,
            brake: command.brake,
            drives: command.drives.duty != [0.0; 2],
            tool_is_on: status.tool_level > 0.0,
            moves: moves(status),
            directions: if homes {
                status.velocity.map(direction)
            } else {
                [0; 2]
            },
            has_path: snapshot.path_left > 0.0,
            // Elsewhere the queue is dropped as soon as the planner runs.
            is_planned: outside.is_planned && follows,
            is_held: snapshot.hold.is_some(),
            // Elsewhere it ends as soon as the planner runs.
            streams: outside
                .stream
                .is_some_and(|phase| phase != StreamPhase::Ended)
                && follows,
            yields: status.state == State::Compliant
                && matches!(
                    outside.stream,
                    Some(StreamPhase::Waits | StreamPhase::Follows)
                ),
            is_left: snapshot.assembly == Side::Left,
            has_settings: outside.has_settings,
            // Without power the host's silence ends nothing.
            is_silent: outside.is_silent && powered,
            zeros_are_wrong: outside.zeros_are_wrong,
            disturbance: outside.disturbance,
            age: Age::New,
        }
    }

    pub(super) fn has_power(&self) -> bool {
        self.powered
    }

    /// Whether the arm is in a motion, or in a state that ends by itself.
    pub(super) fn is_moving(&self) -> bool {
        match self.state {
            State::Homing
            | State::Exciting
            | State::Crossing
            | State::Compliant
            | State::Running
            | State::Stopping => true,
            State::Stopped | State::Armed | State::Fault => self.moves,
        }
    }

    /// This view, after it has lasted for so many ticks.
    pub(super) fn aged(self, ticks: u32) -> Self {
        let age = match ticks {
            0..=1 => Age::New,
            2..=7 if self.powered => Age::Young,
            _ => Age::Old,
        };
        Self { age, ..self }
    }
}

/// Whether the reference of a joint moves.
pub(super) fn moves(status: &Status) -> bool {
    let reference = status.joint_reference;
    reference.is_some_and(|joints| joints.velocity != [0.0; 2])
}
