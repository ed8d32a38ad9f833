//! Streams of set-points: each point becomes a piece of motion behind the last one, together with the stop that follows if
//! no other point comes.
//!
//! A path is checked whole before it begins, a stream cannot be. Instead each piece is checked with its own stop, and
//! the controller's path always ends with the stop of its last piece. So a stream that ends in any tick ends at rest within
//! every limit, and the tick follows pieces as of any path. Before a point is taken the stop lies behind
//! the last piece; a splice puts the new piece in its place, and the new stop behind it.

mod limited;
mod piece;
mod progress;
mod rendering;
mod start;
mod touch;

use super::{Planner, PlanningSnapshot};
use crate::controller::{ArmController, Change, ExtraTorque, QueuedSegment, Splice};
use crate::drives::Drives;
use crate::motion::{StreamConfig, StreamMode, StreamPoint, StreamPolicy};
use crate::safety::Limits;
use fivebar_kinematics::trajectory::{ToolMotion, TrajectorySegment};
use limited::Way;
use piece::Piece;
pub use progress::{StreamError, StreamPhase, StreamProgress, StreamReason};
use rendering::RenderingChange;
use rtic_core::Mutex;
use start::Start;

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
    /// How far it goes towards points that a limit keeps it from.
    share: f32,
    /// The tick of the last such point that it could not go towards.
    kept_in: Option<u32>,
    /// How its springs change.
    change: Option<RenderingChange>,
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
    /// What the host adds to the torques there [N·m].
    torque: [f32; 2],
    /// What follows if no other piece does.
    stop: TrajectorySegment<f32>,
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

    /// Notes that the arm follows the n-th point.
    fn take(&mut self, n: u16) {
        let progress = &mut self.progress;
        let missing = progress.last.map_or(0, |last| n.wrapping_sub(last) - 1);
        progress.lost = progress.lost.saturating_add(missing);
        progress.last = Some(n);
        progress.phase = StreamPhase::Follows;
        self.refused_in_a_row = 0;
    }

    /// Notes how a point was taken or why not.
    fn note(&mut self, n: u16, taken: Result<(), StreamReason>) {
        let progress = &mut self.progress;
        let more = |count: u16| count.saturating_add(1);
        match taken {
            Ok(()) => return self.take(n),
            Err(StreamReason::Late) => progress.late = more(progress.late),
            Err(StreamReason::Limit(_)) if self.config.policy == StreamPolicy::Limit => {
                progress.limited = more(progress.limited);
            }
            Err(_) => progress.refused = more(progress.refused),
        }
        progress.reason = taken.err();
        match taken {
            // A host that has to come back to the arm sends more than three of them.
            Ok(()) | Err(StreamReason::Late | StreamReason::Away(_)) => {}
            Err(StreamReason::Limit(_)) if self.config.policy == StreamPolicy::Limit => {
                self.take(n);
            }
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
    /// Begins a stream of set-points, where the arm is held and has nothing to do. The stream before is forgotten. With the number
    /// of a stream with an impedance that is in progress, its springs and dampers change.
    ///
    /// # Errors
    /// Why it does not begin; nothing has changed then.
    pub fn begin_stream(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        config: &StreamConfig,
    ) -> Result<(), StreamError> {
        if let (Some(stream), StreamMode::Impedance(impedance)) = (&self.stream, &config.mode)
            && stream.is_active()
            && stream.config.id == config.id
        {
            return self.set_impedance(controller, impedance);
        }
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
                limited: 0,
            },
            refused_in_a_row: 0,
            path_generation: snapshot.path_generation,
            end: None,
            share: 1.0,
            kept_in: None,
            change: None,
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
        let now = self.watch_stream(controller, &snapshot);
        let Some(mut stream) = self.stream.filter(|stream| stream.takes(point.id)) else {
            return;
        };
        let taken = match now {
            Some(now) => self.follow_point(controller, &snapshot, &mut stream, (n, point), now),
            None => Self::feed_touch(controller, &stream, n, point),
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

    /// Looks whether the stream still has the arm, whether it has run dry, and whether its host is silent. Returns the tick in
    /// which it looked; none where the arm gives way, or no stream has it.
    pub(super) fn watch_stream(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        snapshot: &PlanningSnapshot,
    ) -> Option<u32> {
        self.follow(snapshot);
        let coast = self.coast();
        let stream = self.stream.as_mut().filter(|stream| stream.is_active())?;
        if stream.config.mode.gives_way() {
            stream.watch_touch(controller, snapshot.state);
            return None;
        }
        let is_own = stream.path_generation == snapshot.path_generation;
        if !(is_own && snapshot.state.follows_paths()) {
            stream.end(StreamReason::Stopped);
            stream.progress.phase = StreamPhase::Ended;
            stream.end = None;
            return None;
        }
        let tick = controller.lock(|controller| {
            controller.latch_silence();
            controller.ticks()
        });
        let since = |then: u32| tick.wrapping_sub(then) as i32;
        let is_over = stream.end.is_none_or(|end| since(end.tick) > coast as i32);
        let is_kept = |then: u32| since(then) <= coast as i32;
        let is_dry = is_over && !stream.kept_in.is_some_and(is_kept);
        if is_dry && stream.progress.phase == StreamPhase::Follows {
            stream.progress.phase = StreamPhase::Starved;
        }
        if stream.end.is_some_and(|end| since(end.tick) > 0) && snapshot.hold.is_some() {
            stream.end = None;
        }
        if stream.end.is_none() && stream.progress.phase == StreamPhase::Ends {
            stream.progress.phase = StreamPhase::Ended;
        }
        Some(tick)
    }

    /// Goes on to the n-th point.
    fn follow_point(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        snapshot: &PlanningSnapshot,
        stream: &mut Stream,
        (n, point): (u16, &StreamPoint),
        now: u32,
    ) -> Result<(), StreamReason> {
        let point = &point.with_known_force();
        if !point.is_finite() {
            return Err(StreamReason::Number);
        }
        if point.force != (0.0, 0.0) && !controller.lock(|controller| controller.gives_torque()) {
            return Err(StreamReason::Force);
        }
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
            Some(end) => self.go_on(stream, end, now, point.due)?,
            None => return self.start_from_rest(controller, snapshot, stream, (n, point), now),
        };
        let ticks = point.due.wrapping_sub(start.from.tick);
        let most = u32::from(stream.config.delay).min(self.ticks_of(LONGEST_PIECE));
        if ticks > most.max(stream.config.period.into()) {
            return Err(StreamReason::Gap);
        }
        let way = Way {
            from: start.from,
            after: start.ends_after.unwrap_or(0.0),
            ticks,
        };
        let towards = self.piece_towards(stream, &way, (n, point), now);
        let stops = stream.config.policy == StreamPolicy::Stop;
        let (piece, kept_from) = towards.map_err(|reason| match (reason, start.ends_after) {
            // It came so late that the arm cannot be there in time; the next one gives more.
            (StreamReason::Limit(_), Some(_)) if stops => StreamReason::Late,
            (reason, _) => reason,
        })?;
        self.splice(controller, stream, &start, &piece)?;
        kept_from.map_or(Ok(()), Err)
    }

    /// Hands the controller a piece with its stop, in accesses of which none is longer than a segment's copy.
    fn splice(
        &self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        stream: &mut Stream,
        start: &Start,
        piece: &Piece,
    ) -> Result<(), StreamReason> {
        let motion = queued(&piece.motion, true, start.from.torque, piece.torque);
        let stop = queued(&piece.stop, false, piece.torque, [0.0; 2]);
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
            torque: piece.torque,
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

/// A segment along which the host's torques pass from the first to the second [N·m].
fn queued(
    segment: &TrajectorySegment<f32>,
    open: bool,
    begin: [f32; 2],
    end: [f32; 2],
) -> QueuedSegment {
    let ([begin1, begin4], [end1, end4]) = (begin, end);
    let per_duration = 1.0 / segment.duration();
    QueuedSegment {
        segment: *segment,
        open,
        limits: Limits::empty(),
        extra: ExtraTorque {
            begin,
            rate: [
                (end1 - begin1) * per_duration,
                (end4 - begin4) * per_duration,
            ],
        },
    }
}
