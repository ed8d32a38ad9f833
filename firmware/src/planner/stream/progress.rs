//! What a stream of set-points has done, and why it ends: small enough to be sent.

use crate::planner::MoveErrorKind;
use crate::safety::State;
use core::fmt;
use serde::{Deserialize, Serialize};

/// Why a stream does not begin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum StreamError {
    /// The arm is not armed.
    State(State),
    /// The arm moves, wakes up or has moves queued.
    Moving,
    /// The delay is not 2 to 200 ms, or it is not one to 26 periods.
    Rate,
    /// The motors give no torque, they follow a motion: steppers and hobby servos give way to no hand.
    NoTorque,
    /// The motors are behind belts, so their angles are not those of the joints.
    Belts,
    /// The torques act more than 2.25 ms after the angles that they are for, as over a CAN bus.
    LateTorque,
    /// A matrix of the impedance is not finite, or it would push the tool away: it is not positive semidefinite.
    Matrix,
    /// This wall or guide, counted from 0, has a number that is not finite or less than 0, a direction of no length, or no radius.
    Fixture(u8),
    /// The springs of the impedance, of its walls and of its guides would give energy. With the dampers as they are and all springs
    /// made softer by one factor, they are passive at this pose with so many N/m together.
    Stiffness(f32),
    /// The dampers alone would give energy: made smaller by one factor, they are passive at this pose with less than so many N·s/m
    /// together.
    Damping(f32),
    /// The stream in progress has no impedance that could change.
    NoImpedance,
}

/// What a stream does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StreamPhase {
    /// The arm rests and waits for the first point.
    Waits,
    /// The arm follows points.
    Follows,
    /// No point came in time: the arm comes to rest, or rests. A point near it goes on.
    Starved,
    /// No more points are taken: the arm comes to rest.
    Ends,
    /// It has ended, and the arm rests or has a fault.
    Ended,
}

/// Why a stream ends, or why it has not taken a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum StreamReason {
    /// The host ended it.
    Asked,
    /// A stop, a fault, a disarm or another session ended it.
    Stopped,
    /// The point came too late to be followed.
    Late,
    /// A number is infinite or not a number.
    Number,
    /// The point is due more than 250 ms ahead.
    Early,
    /// The point is due no later than the one before, or its number has come.
    Order,
    /// There is no room for another point.
    Full,
    /// More than the delay, or more than 60 ms, are between the point and the one before.
    Gap,
    /// The first point, or the first one after a rest, is so far from the arm [rad or m].
    Away(f32),
    /// The motion to the point, or the stop behind it, would pass a limit: the arm stops before, or it goes towards the point
    /// as far as it may.
    Limit(MoveErrorKind),
    /// No points came, so an arm that gave way is held.
    Silent,
    /// The point has a force, and the motors give none: they follow a motion.
    Force,
}

/// What a stream has done so far. The counts saturate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StreamProgress {
    /// The number of the stream.
    pub id: u32,
    /// What it does.
    pub phase: StreamPhase,
    /// The latest reason.
    pub reason: Option<StreamReason>,
    /// The number of the point taken last.
    pub last: Option<u16>,
    /// Points that came too late.
    pub late: u16,
    /// Points that never came, over which the motion was bridged.
    pub lost: u16,
    /// Points that were refused.
    pub refused: u16,
    /// Points that a limit kept the arm from, where the stream goes on.
    pub limited: u16,
}

impl fmt::Display for StreamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::State(state) => write!(f, "no stream begins while {state:?}: arm first"),
            Self::Moving => {
                f.write_str("a stream begins where the arm rests and has nothing to do")
            }
            Self::Rate => f.write_str("the delay must be 2 to 200 ms, and one to 26 periods"),
            Self::NoTorque => f.write_str(
                "steppers and hobby servos follow a motion and give no torque: a hand leads arms with brushed motors",
            ),
            Self::LateTorque => f.write_str(
                "the torques, as those over a CAN bus, act more than 2.25 ms late: a hand leads arms with brushed motors",
            ),
            Self::Matrix => f.write_str(
                "the stiffness or the damping is not finite, or it is negative along some direction",
            ),
            Self::Fixture(n) => write!(
                f,
                "wall or guide {n} has a number that is not finite or negative, no direction or no radius",
            ),
            Self::Stiffness(most) => write!(
                f,
                "the springs together must have at most {most} N/m at this pose, or they give energy: make them softer or their dampers smaller",
            ),
            Self::Damping(most) => write!(
                f,
                "the dampers together must have less than {most} N·s/m at this pose, or they give energy: make them smaller",
            ),
            Self::NoImpedance => f.write_str(
                "the stream in progress has no impedance that could change: end it first",
            ),
            Self::Belts => f.write_str(
                "the motors are behind belts, and the hand turns the joints: no hand leads this arm",
            ),
        }
    }
}

impl core::error::Error for StreamError {}

impl fmt::Display for StreamReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Asked => "the host ended the stream",
            Self::Stopped => "a stop, a fault or another session ended the stream",
            Self::Late => "a point came too late: give a longer delay",
            Self::Number => "a number of a point is infinite or not a number",
            Self::Early => "a point is due more than 250 ms ahead",
            Self::Order => "a point is due no later than the one before, or its number has come",
            Self::Full => "points come faster than the stream's period",
            Self::Gap => "more than the delay, or than 60 ms, are between two points",
            Self::Away(distance) => {
                return write!(
                    f,
                    "the first point is {distance} rad or m from the arm: move there first"
                );
            }
            Self::Limit(kind) => return write!(f, "a limit keeps the arm from a point: {kind}"),
            Self::Silent => "no points came, so the arm is held",
            Self::Force => {
                "a point has a force or torques, and these motors give none: they follow a motion"
            }
        })
    }
}
