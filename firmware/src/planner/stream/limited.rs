//! Points that a limit keeps the arm from, in a stream that goes on: the arm goes towards them as fast as its limits let it.
//!
//! The arm is at p with v, and T later the point is at q with w. Towards it the tool would need the velocity
//! u = w + e min(1/τ, √(a/|e|)), e = q − p − T (v + w)/2. Without another piece it stops, and has s then. The piece gives it
//! s + λ (u − s) at a constant acceleration. λ is halved or quartered where a limit is in the way, and doubled with each
//! point, so that few pieces are tried in a period. Where none passes, the arm goes on along its stop.

use super::piece::Piece;
use super::{Planner, Stream, StreamEnd, StreamMode, StreamPoint, StreamReason};
use crate::motion::StreamPolicy;
use fivebar_kinematics::trajectory::{Reference, ToolMotion};
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// τ in periods, and at least [s].
const APPROACH: (f32, f32) = (5.0, 0.01);
/// a as a share of the tool's acceleration.
const BRAKING: f32 = 0.5;
/// The next λ that is tried where the first one was too much, as a share of it.
const LESS: f32 = 0.25;
/// The least λ.
const LEAST: f32 = 1.0 / 256.0;

/// From where a piece goes to a point, and how long it takes.
pub(super) struct Way {
    pub(super) from: StreamEnd,
    /// The time in the stop at which it begins [s].
    pub(super) after: f32,
    /// Its duration.
    pub(super) ticks: u32,
}

impl Planner {
    /// The piece to a point; where a limit keeps the arm from it and the stream goes on, one towards it, with the limit.
    ///
    /// # Errors
    /// The limit; the arm stops then, or goes on along its stop.
    pub(super) fn piece_towards(
        &self,
        stream: &mut Stream,
        way: &Way,
        (n, point): (u16, &StreamPoint),
        now: u32,
    ) -> Result<(Piece, Option<StreamReason>), StreamReason> {
        let mode = stream.config.mode;
        let reason = match self.piece(&way.from, mode, point, way.ticks, n) {
            Ok(piece) => {
                (stream.share, stream.kept_in) = (1.0, None);
                return Ok((piece, None));
            }
            Err(reason) => reason,
        };
        if stream.config.policy == StreamPolicy::Stop {
            return Err(reason);
        }
        stream.kept_in = Some(now);
        let target = match mode {
            StreamMode::Joint => self.tool_motion(point.position.into(), point.velocity.into())?,
            StreamMode::Tip | StreamMode::Free | StreamMode::Impedance(_) => ToolMotion {
                position: Vector2::new(point.position.0, point.position.1),
                velocity: Vector2::new(point.velocity.0, point.velocity.1),
            },
        };
        let (stopping, wanted) = self.velocities(stream, way, &target);
        for factor in [2.0, 2.0 * LESS] {
            let share = (factor * stream.share).clamp(LEAST, 1.0);
            if let Some(piece) = self.piece_of(way, stopping + (wanted - stopping) * share, n) {
                stream.share = share;
                return Ok((piece, Some(reason)));
            }
        }
        stream.share = (LESS * stream.share).max(LEAST);
        Err(reason)
    }

    /// The tool's velocities at the end of a piece [m/s]: along the stop, and towards a point.
    fn velocities(
        &self,
        stream: &Stream,
        way: &Way,
        target: &ToolMotion<f32>,
    ) -> (Vector2<f32>, Vector2<f32>) {
        let period = 1.0 / self.tick_rate;
        let time = period * way.ticks as f32;
        let stop = &way.from.stop;
        let stopping = match stop.evaluate((way.after + time).min(stop.duration())) {
            Reference::Tool { velocity, .. } => velocity,
            Reference::Joint { .. } => Vector2::zeros(),
        };
        let from = &way.from.tool;
        let mean = (from.velocity + target.velocity) * 0.5;
        let away = target.position - from.position - mean * time;
        let (periods, least) = APPROACH;
        let approach = (periods * period * f32::from(stream.config.period)).max(least);
        let acceleration = BRAKING * self.envelope.tool_motion.acceleration;
        let distance = away.length();
        let braking = Scalar::sqrt(acceleration / distance.max(f32::MIN_POSITIVE));
        let rate = braking.min(1.0 / approach.max(time));
        (stopping, target.velocity + away * rate)
    }

    /// The piece to this velocity [m/s] at a constant acceleration; none if it passes a limit.
    fn piece_of(&self, way: &Way, velocity: Vector2<f32>, n: u16) -> Option<Piece> {
        let time = way.ticks as f32 / self.tick_rate;
        let from = &way.from.tool;
        let position = from.position + (from.velocity + velocity) * (0.5 * time);
        let point = StreamPoint {
            id: 0,
            due: 0,
            position: (position.x, position.y),
            velocity: (velocity.x, velocity.y),
            force: (0.0, 0.0),
        };
        self.piece(&way.from, StreamMode::Tip, &point, way.ticks, n)
            .ok()
    }
}
