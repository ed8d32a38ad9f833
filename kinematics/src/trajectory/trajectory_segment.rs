//! The trajectory segment that the tick follows: one shape and one cubic time law.

use super::curve::Curve;
use super::reference::Reference;
use crate::Scalar;
use nalgebra::Vector2;

/// s(t) = s₀ + ṡ₀ t + ½ s̈₀ t² + ⅙ s⃛ t³, units per second.
///
/// ```
/// use fivebar_kinematics::trajectory::TimeLaw;
///
/// // From 0.1 m at 0.2 m/s and 1 m/s², with a jerk of 6 m/s³, for 0.1 s.
/// let state = TimeLaw::new(0.1, 0.2, 1.0, 6.0).at(0.1);
/// assert!((state.s - 0.126_f64).abs() < 1e-15);
/// assert!((state.s_dot - 0.33_f64).abs() < 1e-15);
/// assert!((state.s_ddot - 1.6_f64).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeLaw<S> {
    /// s₀, ṡ₀, ½ s̈₀, ⅙ s⃛.
    coefficients: [S; 4],
}

impl<S: Scalar> TimeLaw<S> {
    /// From s, ṡ and s̈ at t = 0, and the constant jerk s⃛.
    #[inline]
    pub fn new(s: S, s_dot: S, s_ddot: S, jerk: S) -> Self {
        Self {
            coefficients: [s, s_dot, s_ddot * S::HALF, jerk * S::from_f64(1.0 / 6.0)],
        }
    }

    /// s, ṡ and s̈ at time `t` [s].
    #[inline(always)]
    pub fn at(&self, t: S) -> PathState<S> {
        let [c0, c1, c2, c3] = self.coefficients;
        // Horner's scheme thrice over: s, ṡ and ½ s̈.
        let (p, d) = (c3 * t + c2, c3);
        let (p, d, e) = (p * t + c1, d * t + p, c3);
        let (p, d, e) = (p * t + c0, d * t + p, e * t + d);
        PathState {
            s: p,
            s_dot: d,
            s_ddot: e + e,
        }
    }
}

/// The state of the motion along a path: s, ṡ and s̈. The unit of s is [m] along a curve,
/// [rad] of the joint that turns further in a joint move.
///
/// ```
/// use fivebar_kinematics::trajectory::TimeLaw;
///
/// // 0.2 m/s and 1 m/s²; at half the rate of time the speed is halved, the acceleration quartered.
/// let state = TimeLaw::new(0.1, 0.2, 1.0, 0.0).at(0.0);
/// let slow = state.time_scaled(0.5, 0.0);
/// assert_eq!((slow.s, slow.s_dot, slow.s_ddot), (0.1, 0.1, 0.25));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathState<S> {
    /// Distance from the start of the segment, s [m or rad].
    pub s: S,
    /// ṡ [m/s or rad/s].
    pub s_dot: S,
    /// s̈ [m/s² or rad/s²].
    pub s_ddot: S,
}

impl<S: Scalar> PathState<S> {
    /// The state at the same s when time along the path runs at the rate σ, which changes
    /// by σ̇ [1/s]: the speed is σ ṡ, the acceleration σ² s̈ + σ̇ ṡ.
    #[inline(always)]
    #[must_use]
    pub fn time_scaled(self, sigma: S, sigma_dot: S) -> Self {
        Self {
            s: self.s,
            s_dot: self.s_dot * sigma,
            s_ddot: self.s_ddot * (sigma * sigma) + self.s_dot * sigma_dot,
        }
    }
}

/// What a segment moves along.
// With a tag of its own, not in the curve's: the tick tells it with fewer instructions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(u32)]
pub(super) enum Shape<S> {
    /// The tool along a curve, s in metres.
    Path(Curve<S>),
    /// The tool at rest.
    Rest(Vector2<S>),
    /// The joints from `from` [rad] along `direction`, s in radians of the joint that
    /// turns further.
    Joint { from: [S; 2], direction: [S; 2] },
}

/// The output of a tool along a segment: a value at rest, and what speed adds to it. The unit is
/// the caller's.
///
/// ```
/// use fivebar_kinematics::trajectory::ToolOutput;
///
/// // 10 at any speed; and 200 per m/s.
/// assert_eq!(ToolOutput::constant(10.0).at(0.3), 10.0);
/// assert_eq!(ToolOutput { at_rest: 0.0, per_speed: 200.0 }.at(0.25), 50.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolOutput<S> {
    /// The output at rest.
    pub at_rest: S,
    /// The output per speed ṡ [s/m or s/rad].
    pub per_speed: S,
}

impl<S: Scalar> ToolOutput<S> {
    /// The same output at every speed.
    pub const fn constant(at_rest: S) -> Self {
        Self {
            at_rest,
            per_speed: S::ZERO,
        }
    }

    /// The output at speed `s_dot` [m/s or rad/s].
    #[inline(always)]
    pub fn at(&self, s_dot: S) -> S {
        self.at_rest + self.per_speed * s_dot
    }
}

/// A segment of motion with a duration, continuous with its neighbours in position, velocity
/// and acceleration.
///
/// ```
/// use fivebar_kinematics::trajectory::{LookaheadPlanner, MotionLimits, Reference};
///
/// let limits = MotionLimits { speed: 2.0, acceleration: 20.0, jerk: 1000.0 };
/// let mut planner = LookaheadPlanner::<f64, 4>::new();
/// planner.push_joint([2.0, 1.1], [2.5, 1.1], limits, 7)?;
/// let first = planner.next_segment().ok_or("no segment")?;
/// // The jerk builds up the acceleration within 20 ms.
/// assert_eq!(first.tag(), 7);
/// assert!((first.duration() - 0.02).abs() < 1e-12);
/// let Reference::Joint { accelerations, .. } = first.evaluate(0.01) else { panic!("a joint move") };
/// assert!((accelerations[0] - 10.0).abs() < 1e-9); // rad/s²
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectorySegment<S> {
    pub(super) shape: Shape<S>,
    pub(super) law: TimeLaw<S>,
    pub(super) duration: S,
    pub(super) tag: u32,
    pub(super) tool: ToolOutput<S>,
}

impl TrajectorySegment<f32> {
    /// No time at rest at A.
    pub const NONE: Self = Self {
        shape: Shape::Rest(Vector2::new(0.0, 0.0)),
        law: TimeLaw {
            coefficients: [0.0; 4],
        },
        duration: 0.0,
        tag: 0,
        tool: ToolOutput::constant(0.0),
    };
}

impl<S: Scalar> TrajectorySegment<S> {
    /// The tool at rest at `position` [m] for `duration` [s].
    pub fn rest(position: Vector2<S>, duration: S, tag: u32) -> Self {
        Self {
            shape: Shape::Rest(position),
            law: TimeLaw::new(S::ZERO, S::ZERO, S::ZERO, S::ZERO),
            duration,
            tag,
            tool: ToolOutput::constant(S::ZERO),
        }
    }

    /// The tool along `curve` by `law` for `duration` [s], a motion that was planned elsewhere.
    pub fn along(
        curve: Curve<S>,
        law: TimeLaw<S>,
        duration: S,
        tag: u32,
        tool: ToolOutput<S>,
    ) -> Self {
        Self {
            shape: Shape::Path(curve),
            law,
            duration,
            tag,
            tool,
        }
    }

    /// Becomes a copy of another one. Each field is copied in place; for the whole, the compiler calls
    /// `memcpy`, whose time has no bound of its own.
    #[inline(always)]
    pub fn copy_from(&mut self, other: &Self) {
        self.shape = other.shape;
        self.law = other.law;
        self.duration = other.duration;
        self.tag = other.tag;
        self.tool = other.tool;
    }

    /// Ends it after `duration` [s].
    #[inline]
    pub fn end_after(&mut self, duration: S) {
        self.duration = duration;
    }

    /// Its duration [s]; may be shorter than a tick.
    #[inline]
    pub fn duration(&self) -> S {
        self.duration
    }

    /// The tag of the move to which this segment belongs. A rounded corner has the tag of the
    /// move after it.
    #[inline]
    pub fn tag(&self) -> u32 {
        self.tag
    }

    /// The output of the tool along it.
    #[inline(always)]
    pub fn tool_output(&self) -> &ToolOutput<S> {
        &self.tool
    }

    /// The curve along which it moves the tool; `None` for a dwell or a joint move.
    pub fn curve(&self) -> Option<&Curve<S>> {
        match &self.shape {
            Shape::Path(curve) => Some(curve),
            Shape::Rest(_) | Shape::Joint { .. } => None,
        }
    }

    /// Where it holds the tool at rest [m]; `None` for a segment that moves.
    #[inline(always)]
    pub fn place_of_rest(&self) -> Option<Vector2<S>> {
        match self.shape {
            Shape::Rest(position) => Some(position),
            Shape::Path(_) | Shape::Joint { .. } => None,
        }
    }

    /// s, ṡ and s̈ at time `t` [s] into the segment, 0 ≤ t ≤ duration.
    #[inline(always)]
    pub fn path_state(&self, t: S) -> PathState<S> {
        self.law.at(t)
    }

    /// The reference at time `t` [s] into the segment, 0 ≤ t ≤ duration.
    #[inline(always)]
    pub fn evaluate(&self, t: S) -> Reference<S> {
        self.reference(self.path_state(t))
    }

    /// The reference at a state of the motion along the segment.
    #[inline(always)]
    pub fn reference(&self, path_state: PathState<S>) -> Reference<S> {
        let PathState { s, s_dot, s_ddot } = path_state;
        match &self.shape {
            Shape::Path(curve) => {
                let [position, velocity, acceleration] = curve.motion(s, s_dot, s_ddot);
                Reference::Tool {
                    position,
                    velocity,
                    acceleration,
                }
            }
            Shape::Rest(position) => Reference::Tool {
                position: *position,
                velocity: Vector2::zeros(),
                acceleration: Vector2::zeros(),
            },
            Shape::Joint { from, direction } => {
                let [from1, from4] = *from;
                let [d1, d4] = *direction;
                Reference::Joint {
                    angles: [from1 + d1 * s, from4 + d4 * s],
                    rates: [d1 * s_dot, d4 * s_dot],
                    accelerations: [d1 * s_ddot, d4 * s_ddot],
                }
            }
        }
    }
}
