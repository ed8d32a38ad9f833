//! Trajectories: from moves of the tool to the reference that the tick follows.
//!
//! ```text
//! Segment::line, Segment::arc        the geometry of a move
//!   │ Envelope::admit                the whole of it checked, and how fast it may go
//!   ▼
//! LookAhead::push                    corners rounded or stopped at, speeds planned
//!   │ LookAhead::next_piece          committed
//!   ▼
//! Piece::evaluate(t) → Reference     position, velocity, acceleration, each tick
//! ```
//!
//! Geometry and time are kept apart. The path is a row of curves whose tangent and
//! curvature run on where they meet, or that are stopped between; along it a single
//! jerk-limited time law s(t), a cubic from one change of jerk to the next, runs through
//! corners and all. A [`Piece`] is one curve and one cubic, so that the tick evaluates
//! polynomials, and one sine and cosine on an arc.

mod admission;
mod blend;
mod bounds;
mod curve;
mod envelope;
mod horizon;
mod look_ahead;
mod number;
mod piece;
mod plan;
mod queue;
mod ramp;
mod reference;
mod refusal;
mod segment;
mod speed_cap;
mod walk;

pub use curve::{Curve, CurvePoint};
pub use envelope::{Envelope, TorqueLimits};
pub use look_ahead::{LookAhead, PushError};
pub use piece::{Piece, Progress, TimeLaw};
pub use ramp::Caps;
pub use reference::Reference;
pub use refusal::{Obstacle, Refusal};
pub use segment::{Segment, SegmentError, Sense};
