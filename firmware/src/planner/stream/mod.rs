//! Streams of set-points: each point becomes a piece of motion behind the last one, together with the stop that follows if
//! no other point comes.
//!
//! A path is checked whole before it begins, a stream cannot be. Instead each piece is checked with its own stop, and
//! the controller's path always ends with the stop of its last piece. So a stream that ends in any tick ends at rest within
//! every limit, and the tick follows pieces as of any path. Before a point is taken the stop lies behind
//! the last piece; a splice puts the new piece in its place, and the new stop behind it.

mod piece;
mod progress;
mod rendering;
mod touch;

use super::{Planner, PlanningSnapshot};
use crate::controller::{ArmController, Change, QueuedSegment, Splice};
use crate::drives::Drives;
use crate::motion::{StreamConfig, StreamMode, StreamPoint};
use crate::safety::Limits;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::trajectory::{Reference, ToolMotion, TrajectorySegment};
use nalgebra::Vector2;
use piece::Piece;
pub use progress::{StreamError, StreamPhase, StreamProgress, StreamReason};
use rtic_core::Mutex;

/// The delay [s], at least and at most.
const DELAY: [f32; 2] = [2e-3, 0.2];
/// The most periods of a delay: their pieces and a stop have room in the path's queue.
const MOST_PERIODS: u16 = 26;
/// How far ahead a point may be due [s].
const EARLIEST: f32 = 0.25;
/// The longest piece [s].
const LONGEST_PIECE: f32 = 0.06;
/// The longest time for which the last velocity is nearly kept [s], and so many periods at most.
const COAST: (f32, u32) = (0.02, 2);
/// The time in which a piece is made [s]: it begins no sooner.
const LEAD: f32 = 1e-3;
/// How far from the arm the first point may be [rad], [m].
const NEAR: (f32, f32) = (1e-3, 5e-4);
/// Refused points in a row that end a stream.
const REFUSED_IN_A_ROW: u8 = 3;

/// A stream in progress, or one that has ended.
#[derive(Clone, Copy)]
pub(super) struct Stream {
    config: StreamConfig,
    progress: StreamProgress,
    refused_in_a_row: u8,
    /// The controller's path generation when the stream began.
    path_generation: u32,
    /// Where it is at the end of its last piece; none while the arm rests.
    end: Option<StreamEnd>,
}

/// The end of a stream's last piece.
#[derive(Clone, Copy)]
struct StreamEnd {
    /// The tick in which it is reached.
    tick: u32,
    /// The number of segments ever pushed up to there.
    segments: u32,
    /// The tool there.
    tool: ToolMotion<f32>,
    /// θ1, θ4 [rad].
    angles: [f32; 2],
    /// What follows if no other piece does.
    stop: TrajectorySegment<f32>,
}

/// Where and when the next piece begins.
struct Start {
    from: StreamEnd,
    /// The number with the last committed segment.
    last: u32,
    /// The time after which that ends [s]; none: the piece takes its place.
    ends_after: Option<f32>,
}

impl Stream {
    fn is_active(&self) -> bool {
        self.progress.phase != StreamPhase::Ended
    }

    fn takes(&self, id: u32) -> bool {
        let phase = self.progress.phase;
        let takes = !matches!(phase, StreamPhase::Ends | StreamPhase::Ended);
        takes && id == self.config.id
    }

    /// Whether no point with this number or a later one has come.
    fn is_next(&self, n: u16) -> bool {
        let last = self.progress.last;
        last.is_none_or(|last| (n.wrapping_sub(last) as i16) > 0)
    }

    /// Takes no more points.
    fn end(&mut self, reason: StreamReason) {
        if self.takes(self.config.id) {
            self.progress.phase = StreamPhase::Ends;
            self.progress.reason = Some(reason);
        }
    }

    /// Notes how a point was taken or why not.
    fn note(&mut self, n: u16, taken: Result<(), StreamReason>) {
        let progress = &mut self.progress;
        let more = |count: u16| count.saturating_add(1);
        match taken {
            Ok(()) => {
                let missing = progress.last.map_or(0, |last| n.wrapping_sub(last) - 1);
                progress.lost = progress.lost.saturating_add(missing);
                progress.last = Some(n);
                progress.phase = StreamPhase::Follows;
                self.refused_in_a_row = 0;
                return;
            }
            Err(StreamReason::Late) => progress.late = more(progress.late),
            Err(_) => progress.refused = more(progress.refused),
        }
        progress.reason = taken.err();
        match taken {
            // A host that has to come back to the arm sends more than three of them.
            Ok(()) | Err(StreamReason::Late | StreamReason::Away(_)) => {}
            Err(reason @ StreamReason::Limit(_)) => self.end(reason),
            Err(reason) => {
                self.refused_in_a_row = self.refused_in_a_row.saturating_add(1);
                if self.refused_in_a_row >= REFUSED_IN_A_ROW {
                    self.end(reason);
                }
            }
        }
    }
}

impl Planner {
    /// Begins a stream of set-points, where the arm is held and has nothing to do. The stream before is forgotten.
    ///
    /// # Errors
    /// Why it does not begin; nothing has changed then.
    pub fn begin_stream(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        config: &StreamConfig,
    ) -> Result<(), StreamError> {
        let snapshot = controller.lock(|controller| controller.planning_snapshot());
        self.follow(&snapshot);
        if !snapshot.state.follows_paths() {
            return Err(StreamError::State(snapshot.state));
        }
        let is_free = controller.lock(|controller| controller.lets_stream());
        if !is_free || !self.is_empty() || self.is_streaming() {
            return Err(StreamError::Moving);
        }
        let [least, most] = DELAY;
        let delay = f32::from(config.delay) / self.tick_rate;
        let periods = config.delay.checked_div(config.period);
        let fits = periods.is_some_and(|periods| (1..=MOST_PERIODS).contains(&periods));
        if !(fits && least <= delay && delay <= most) {
            return Err(StreamError::Rate);
        }
        self.begin_touch(controller, snapshot.hold, &config.mode)?;
        // The arm goes on from where it is held, and so does what comes behind the stream.
        self.end = None;
        self.in_motion = None;
        self.used_before = 0.0;
        self.stream = Some(Stream {
            config: *config,
            progress: StreamProgress {
                id: config.id,
                phase: StreamPhase::Waits,
                reason: None,
                last: None,
                late: 0,
                lost: 0,
                refused: 0,
            },
            refused_in_a_row: 0,
            path_generation: snapshot.path_generation,
            end: None,
        });
        Ok(())
    }

    /// Takes the n-th point of a stream, or counts why not.
    // A call of its own: its stack is not that of other commands.
    #[inline(never)]
    pub fn take_point(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        n: u16,
        point: &StreamPoint,
    ) {
        let snapshot = controller.lock(|controller| controller.planning_snapshot());
        self.watch_stream(controller, &snapshot);
        let Some(mut stream) = self.stream.filter(|stream| stream.takes(point.id)) else {
            return;
        };
        let taken = match stream.config.mode {
            StreamMode::Joint | StreamMode::Tip => {
                self.follow_point(controller, &snapshot, &mut stream, n, point)
            }
            StreamMode::Free | StreamMode::Impedance(_) => {
                Self::feed_touch(controller, &stream, n, point)
            }
        };
        stream.note(n, taken);
        self.stream = Some(stream);
    }

    /// Takes no more points of a stream: the arm comes to rest behind the last one.
    pub fn end_stream(&mut self, reason: StreamReason) {
        if let Some(stream) = &mut self.stream {
            stream.end(reason);
        }
    }

    /// What the stream in progress does, or what the last one has done.
    pub fn stream(&self) -> Option<&StreamProgress> {
        self.stream.as_ref().map(|stream| &stream.progress)
    }

    /// Whether a stream has the arm.
    pub(super) fn is_streaming(&self) -> bool {
        self.stream.as_ref().is_some_and(Stream::is_active)
    }

    /// Ticks from this one to the end of the stream's last piece; less than 0 behind it, 0 at rest.
    pub(crate) fn buffered(&self, tick: u32) -> i16 {
        let end = self.stream.as_ref().and_then(|stream| stream.end);
        let ahead = end.map_or(0, |end| end.tick.wrapping_sub(tick) as i32);
        ahead.clamp(i16::MIN.into(), i16::MAX.into()) as i16
    }

    /// Looks whether the stream still has the arm, whether it has run dry, and whether its host is silent.
    pub(super) fn watch_stream(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        snapshot: &PlanningSnapshot,
    ) {
        self.follow(snapshot);
        let coast = self.coast();
        let Some(stream) = self.stream.as_mut().filter(|stream| stream.is_active()) else {
            return;
        };
        if stream.config.mode.gives_way() {
            return stream.watch_touch(controller, snapshot.state);
        }
        let is_own = stream.path_generation == snapshot.path_generation;
        if !(is_own && snapshot.state.follows_paths()) {
            stream.end(StreamReason::Stopped);
            stream.progress.phase = StreamPhase::Ended;
            stream.end = None;
            return;
        }
        let tick = controller.lock(|controller| {
            controller.latch_silence();
            controller.ticks()
        });
        if let Some(end) = stream.end {
            let behind = tick.wrapping_sub(end.tick) as i32;
            if behind > coast as i32 && stream.progress.phase == StreamPhase::Follows {
                stream.progress.phase = StreamPhase::Starved;
            }
            if behind > 0 && snapshot.hold.is_some() {
                stream.end = None;
            }
        }
        if stream.end.is_none() && stream.progress.phase == StreamPhase::Ends {
            stream.progress.phase = StreamPhase::Ended;
        }
    }

    /// Goes on to a point.
    fn follow_point(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        snapshot: &PlanningSnapshot,
        stream: &mut Stream,
        n: u16,
        point: &StreamPoint,
    ) -> Result<(), StreamReason> {
        if !point.is_finite() {
            return Err(StreamReason::Number);
        }
        if point.force != (0.0, 0.0) {
            return Err(StreamReason::Force);
        }
        let now = controller.lock(|controller| controller.ticks());
        let ahead = point.due.wrapping_sub(now) as i32;
        if !stream.is_next(n) {
            return Err(StreamReason::Order);
        }
        if ahead <= 0 {
            return Err(StreamReason::Late);
        }
        if ahead > self.ticks_of(EARLIEST) as i32 {
            return Err(StreamReason::Early);
        }
        let start = match &stream.end {
            // The new piece takes one more slot than its stop, which is in the queue, too.
            Some(_) if snapshot.path_free == 0 => return Err(StreamReason::Full),
            Some(end) => self.go_on(end, now, point.due)?,
            None => return self.start_from_rest(controller, snapshot, stream, (n, point), now),
        };
        let ticks = point.due.wrapping_sub(start.from.tick);
        let most = u32::from(stream.config.delay).min(self.ticks_of(LONGEST_PIECE));
        if ticks > most.max(stream.config.period.into()) {
            return Err(StreamReason::Gap);
        }
        let piece = self.piece(&start.from, stream.config.mode, point, ticks, n)?;
        self.splice(controller, stream, &start, &piece)
    }

    /// Where the next piece begins: at the end of the last one, or where its last velocity is kept.
    fn go_on(&self, end: &StreamEnd, now: u32, due: u32) -> Result<Start, StreamReason> {
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
        if coasted >= self.coast() || due.wrapping_sub(tick) as i32 <= 0 {
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
        Ok(Start {
            from: StreamEnd {
                tick,
                tool,
                angles,
                ..*end
            },
            last: end.segments.wrapping_add(1),
            ends_after: Some(time),
        })
    }

    /// Begins with a point near the held arm: it rests, then goes to the point.
    fn start_from_rest(
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
        let is_near = distance <= near;
        if !is_near {
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
            stop: TrajectorySegment::NONE,
        };
        let piece = self.piece(&from, stream.config.mode, point, ticks, n)?;
        let duration = rests as f32 * (1.0 / self.tick_rate);
        let rest = queued(
            &TrajectorySegment::rest(position, duration, n.into()),
            false,
        );
        let begun = controller
            .lock(|controller| controller.begin_stream_path(stream.path_generation, &rest));
        let [begins, segments] = begun.ok_or(StreamReason::Late)?;
        let start = Start {
            from: StreamEnd {
                tick: begins.wrapping_add(rests),
                ..from
            },
            last: segments,
            ends_after: Some(duration),
        };
        self.splice(controller, stream, &start, &piece)
    }

    /// Hands the controller a piece with its stop, in accesses of which none is longer than a segment's copy.
    fn splice(
        &self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        stream: &mut Stream,
        start: &Start,
        piece: &Piece,
    ) -> Result<(), StreamReason> {
        let (motion, stop) = (queued(&piece.motion, true), queued(&piece.stop, false));
        let duration = piece.motion.duration();
        let mut store = |n, segment: &QueuedSegment, after| {
            controller.lock(|controller| controller.store_for_splice(n, segment, after));
        };
        let behind = start.last.wrapping_add(1);
        let (change, segments) = match start.ends_after {
            None => {
                store(behind, &stop, duration);
                (Change::Replace(&motion), start.last)
            }
            Some(time) => {
                store(behind, &motion, time);
                store(behind.wrapping_add(1), &stop, time + duration);
                (Change::EndAfter(time), behind)
            }
        };
        let splice = Splice {
            begins: start.from.tick,
            last: start.last,
            change,
            commits: segments.wrapping_add(1),
        };
        let generation = stream.path_generation;
        let taken = controller.lock(|controller| controller.splice_path(generation, &splice));
        if !taken {
            return Err(StreamReason::Late);
        }
        stream.end = Some(StreamEnd {
            tick: start.from.tick.wrapping_add(piece.ticks),
            segments,
            tool: piece.tool,
            angles: piece.angles,
            stop: piece.stop,
        });
        Ok(())
    }

    /// The time for which the last velocity is nearly kept, and a point still goes on from it [ticks].
    fn coast(&self) -> u32 {
        let (longest, periods) = COAST;
        let period = self
            .stream
            .as_ref()
            .map_or(0, |stream| stream.config.period);
        (periods * u32::from(period))
            .min(self.ticks_of(longest))
            .max(1)
    }

    fn ticks_of(&self, time: f32) -> u32 {
        (time * self.tick_rate) as u32
    }
}

fn queued(segment: &TrajectorySegment<f32>, open: bool) -> QueuedSegment {
    QueuedSegment {
        segment: *segment,
        open,
        limits: Limits::empty(),
    }
}
