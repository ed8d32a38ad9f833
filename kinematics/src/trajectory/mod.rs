//! Trajectories: from moves of the tool to the reference that the tick follows.
//!
//! ```text
//! PathSegment::line, PathSegment::arc   the geometry of a move
//!   │ Envelope::check                   the whole path checked; gives its motion limits
//!   ▼
//! LookaheadPlanner::push                corners rounded or stopped at, speeds planned
//!   │ LookaheadPlanner::next_segment    committed
//!   ▼
//! TrajectorySegment::evaluate(t)        Reference: position, velocity, acceleration, each tick
//! ```
//!
//! Geometry and time are separate. The path is a sequence of curves. Where two curves meet,
//! tangent and curvature are continuous, or the motion stops. One jerk-limited time law s(t)
//! runs along the whole path; between two changes of jerk it is a cubic. A
//! [`TrajectorySegment`] is one curve and one cubic, so the tick evaluates polynomials, and
//! one sine and cosine on an arc.

mod annulus;
mod blend;
mod bounds;
mod check;
mod corner;
mod curve;
mod envelope;
mod error;
mod hermite;
mod lookahead;
mod motion_limits;
mod near_margin;
mod number;
mod path_segment;
mod profile;
mod queue;
mod ramp;
mod reference;
mod shares;
mod stop;
mod timed;
mod trajectory_segment;
mod verify;
mod window;

pub use curve::{Curve, CurvePoint};
pub use envelope::{Envelope, TorqueLimits};
pub use error::{ConstraintViolation, PathError, PushError};
pub use hermite::ToolMotion;
pub use lookahead::LookaheadPlanner;
pub use path_segment::{PathSegment, PathSegmentError, Sense};
pub use ramp::MotionLimits;
pub use reference::Reference;
pub use stop::StopStart;
pub use trajectory_segment::{PathState, TimeLaw, ToolOutput, TrajectorySegment};
