//! The moves that a host can ask for: in the protocol and in the planner's queue.

mod crossing;
mod impedance;
mod stream;

pub use crossing::CrossingMove;
pub use impedance::{FIXTURES, Fixture, FixtureShape, Impedance};
pub use stream::{StreamConfig, StreamMode, StreamPoint, StreamPolicy};

use fivebar_kinematics::trajectory::{Curve, TimeLaw};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// The level of a tool that is down, or at full power.
pub const FULL_TOOL: u16 = u16::MAX;
/// Greatest error of an arc's centre, from the rounding in its file [m].
pub const ARC_TOLERANCE: f32 = 1e-4;

/// One move. It starts where the move before it ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Move {
    /// The host's number for this move, such as a line of a job. It is repeated in the status
    /// and in errors.
    pub tag: u32,
    /// The level of the tool during the move: 0 is up or off, [`FULL_TOOL`] is down or full power.
    /// It changes where the move begins.
    pub tool: u16,
    /// What to do.
    pub kind: MoveKind,
}

/// The kinds of move. Positions are of the tool in the frame of the base [m].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MoveKind {
    /// Straight to a point.
    Line {
        /// The end [m].
        to: [f32; 2],
        /// Speed along the path [m/s]; the limits may slow it.
        feed: f32,
    },
    /// Along a circle; a full turn if the end is the start.
    Arc {
        /// The end [m].
        to: [f32; 2],
        /// The circle's centre [m].
        center: [f32; 2],
        /// The sense of rotation.
        clockwise: bool,
        /// Speed along the path [m/s]; the limits may slow it.
        feed: f32,
    },
    /// Stand still.
    Dwell {
        /// For how long [s].
        duration: f32,
    },
    /// Both driven joints straight to their angles; both arrive at the same time.
    Joint {
        /// θ1, θ4 [rad].
        to: [f32; 2],
        /// Share of the joints' greatest speed, 0 to 1.
        speed: f32,
    },
    /// A piece of a motion that the host has planned.
    Timed(TimedMove),
    /// Through a singularity of type 2, from one assembly mode to the other, as the host has planned.
    Crossing(CrossingMove),
}

/// The tool along a part of a curve by a time law of the host. The controller follows it as it is,
/// if every limit of the joints is kept. The limits of `motion` are for the controller's own plans
/// and do not apply.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TimedMove {
    /// The curve.
    pub curve: TimedCurve,
    /// s [m], ṡ [m/s], s̈ [m/s²] at its beginning, and the constant s⃛ [m/s³]; s from the curve's
    /// start.
    pub law: [f32; 4],
    /// [s].
    pub duration: f32,
}

impl TimedMove {
    /// Where the tool is at its end [m].
    pub fn end(&self) -> [f32; 2] {
        let [s, s_dot, s_ddot, jerk] = self.law;
        let state = TimeLaw::new(s, s_dot, s_ddot, jerk).at(self.duration);
        Curve::from(self.curve).at(state.s).position.into()
    }
}

/// A curve by its length s, see [`Curve`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TimedCurve {
    /// Straight.
    Line {
        /// Where s is 0 [m].
        start: [f32; 2],
        /// The direction, a unit vector.
        tangent: [f32; 2],
    },
    /// Circular.
    Arc {
        /// Where s is 0 [m].
        start: [f32; 2],
        /// The direction there, a unit vector.
        tangent: [f32; 2],
        /// [1/m], positive where the arc turns left.
        curvature: f32,
    },
    /// Σ cₖ (s/ℓ)ᵏ.
    Blend {
        /// c₀ … c₅ [m].
        coefficients: [[f32; 2]; 6],
        /// 1/ℓ [1/m].
        inverse_length: f32,
    },
}

impl From<TimedCurve> for Curve<f32> {
    fn from(curve: TimedCurve) -> Self {
        let vector = Vector2::from;
        match curve {
            TimedCurve::Line { start, tangent } => Self::Line {
                start: vector(start),
                tangent: vector(tangent),
            },
            TimedCurve::Arc {
                start,
                tangent,
                curvature,
            } => Self::Arc {
                start: vector(start),
                tangent: vector(tangent),
                curvature,
            },
            TimedCurve::Blend {
                coefficients,
                inverse_length,
            } => Self::Blend {
                coefficients: coefficients.map(vector),
                inverse_length,
            },
        }
    }
}
