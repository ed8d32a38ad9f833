//! Where and when the next piece of a stream begins: behind the last one, along its stop, or from rest.

use super::limited::Way;
use super::{
    LONGEST_PIECE, Planner, Stream, StreamEnd, StreamMode, StreamPoint, StreamReason, queued,
};
use crate::controller::ArmController;
use crate::drives::Drives;
use crate::motion::StreamPolicy;
use crate::planner::PlanningSnapshot;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::trajectory::{Reference, ToolMotion, TrajectorySegment};
use nalgebra::Vector2;
use rtic_core::Mutex;

/// The time in which a piece is made [s]: it begins no sooner.
const LEAD: f32 = 1e-3;
/// How far from the arm the first point may be [rad], [m].
const NEAR: (f32, f32) = (1e-3, 5e-4);

/// Where and when the next piece begins.
pub(super) struct Start {
    pub(super) from: StreamEnd,
    /// The number with the last committed segment.
    pub(super) last: u32,
    /// The time after which that ends [s]; none: the piece takes its place.
    pub(super) ends_after: Option<f32>,
}

impl Planner {
    /// Where the next piece begins: at the end of the last one, or where its last velocity is kept, or along its stop in a stream
    /// that limits do not end.
    pub(super) fn go_on(
        &self,
        stream: &Stream,
        end: &StreamEnd,
        now: u32,
        due: u32,
    ) -> Result<Start, StreamReason> {
        let lead = self.ticks_of(LEAD).max(2);
        if end.tick.wrapping_sub(now) as i32 >= lead as i32 {
            if due.wrapping_sub(end.tick) as i32 <= 0 {
                return Err(StreamReason::Order);
            }
            return Ok(Start {
                from: *end,
                last: end.segments.wrapping_add(1),
                ends_after: None,
            });
        }
        let tick = now.wrapping_add(lead);
        let coasted = tick.wrapping_sub(end.tick);
        let most = match stream.config.policy {
            StreamPolicy::Stop => self.coast(),
            StreamPolicy::Limit => self.ticks_of(end.stop.duration()),
        };
        if coasted >= most || due.wrapping_sub(tick) as i32 <= 0 {
            return Err(StreamReason::Late);
        }
        let time = coasted as f32 * (1.0 / self.tick_rate);
        let Reference::Tool {
            position, velocity, ..
        } = end.stop.evaluate(time)
        else {
            return Err(StreamReason::Late);
        };
        let tool = ToolMotion { position, velocity };
        let (angles, _) = self.joint_motion(&tool, end.angles)?;
        let left = 1.0 - time / end.stop.duration();
        Ok(Start {
            from: StreamEnd {
                tick,
                tool,
                angles,
                torque: end.torque.map(|torque| torque * left),
                ..*end
            },
            last: end.segments.wrapping_add(1),
            ends_after: Some(time),
        })
    }

    /// Begins with a point near the held arm: it rests, then goes to the point.
    pub(super) fn start_from_rest(
        &self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        snapshot: &PlanningSnapshot,
        stream: &mut Stream,
        (n, point): (u16, &StreamPoint),
        now: u32,
    ) -> Result<(), StreamReason> {
        let hold = snapshot.hold.ok_or(StreamReason::Late)?;
        let tool = &self.envelope.workspace.tool;
        let (angles, place) = (hold.joints(), hold.tool(tool, self.assembly));
        let position = place.ok_or(StreamReason::Stopped)?;
        let (near, distance) = match stream.config.mode {
            StreamMode::Joint => {
                let [d1, d4] = [
                    Scalar::abs(point.position.0 - angles[0]),
                    Scalar::abs(point.position.1 - angles[1]),
                ];
                (NEAR.0, d1.max(d4))
            }
            StreamMode::Tip | StreamMode::Free | StreamMode::Impedance(_) => (
                NEAR.1,
                (Vector2::new(point.position.0, point.position.1) - position).norm(),
            ),
        };
        let goes_on = stream.config.policy == StreamPolicy::Limit && stream.progress.last.is_some();
        let is_near = distance <= near;
        if !(is_near || goes_on) {
            return Err(StreamReason::Away(distance));
        }
        let ahead = point.due.wrapping_sub(now);
        let ticks = (ahead / 2).min(self.ticks_of(LONGEST_PIECE));
        let rests = ahead.wrapping_sub(1).wrapping_sub(ticks);
        if ticks == 0 || rests <= self.ticks_of(LEAD).max(2) {
            return Err(StreamReason::Late);
        }
        let from = StreamEnd {
            tick: point.due.wrapping_sub(ticks),
            segments: 0,
            tool: ToolMotion {
                position,
                velocity: Vector2::zeros(),
            },
            angles,
            torque: [0.0; 2],
            stop: TrajectorySegment::NONE,
        };
        let way = Way {
            from,
            after: 0.0,
            ticks,
        };
        let (piece, kept_from) = self.piece_towards(stream, &way, (n, point), now)?;
        let lasts = |ticks: u32| ticks as f32 * (1.0 / self.tick_rate);
        let rest = queued(
            &TrajectorySegment::rest(position, lasts(rests), n.into()),
            false,
            [0.0; 2],
            [0.0; 2],
        );
        let begun = controller
            .lock(|controller| controller.begin_stream_path(stream.path_generation, &rest));
        let [begins, segments] = begun.ok_or(StreamReason::Late)?;
        // Ticks that have passed while the piece was made shorten the rest, so that the point is reached when it is due.
        let rests = from.tick.wrapping_sub(begins);
        if rests as i32 <= 0 {
            return Err(StreamReason::Late);
        }
        let start = Start {
            from,
            last: segments,
            ends_after: Some(lasts(rests)),
        };
        self.splice(controller, stream, &start, &piece)?;
        kept_from.map_or(Ok(()), Err)
    }
}
