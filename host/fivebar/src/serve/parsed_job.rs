//! A job that was read: its moves, and what the controller gets of them.

use super::packed::{Packed, Shelved};
use super::preview::{JobStart, Preview};
use super::wire::message::{Layer, brief};
use fivebar_files::job::{Action, Job, Pause};
use fivebar_firmware::Move;
use fivebar_sim::path_queue::{divided, duration, end, length, remaining};
use fivebar_sim::planned_time::planned_times;
use fivebar_sim::time_optimal::JobPlanner;
use std::sync::Arc;

/// Most layers that pages show.
const MOST_LAYERS: usize = 100;

/// A job that was read. Copies share what is long.
#[derive(Clone)]
pub(super) struct ParsedJob {
    pub(super) name: String,
    /// The text of its file.
    pub(super) text: Arc<Shelved<String>>,
    /// The job, with the changes of mode in place of its steps.
    pub(super) outline: Arc<Job>,
    /// The job as a whole.
    pub(super) job: Arc<Shelved<Job>>,
    pub(super) moves: Arc<Packed<Move>>,
    /// The moves in parts short enough for a new share of the feed rate to take effect soon.
    parts: Arc<Packed<Move>>,
    /// Where it waits for its user, among the parts.
    pauses: Arc<[Pause]>,
    /// What the controller gets: the parts, or a time-optimal motion along them.
    pub(super) pieces: Arc<Packed<Move>>,
    /// The part that each piece belongs to; none: each is its own.
    part_of: Option<Arc<[usize]>>,
    /// The time from the start to the end of each piece [s]: planned, or at the feed rates.
    pub(super) times: Arc<[f64]>,
    /// Whether the times are planned.
    pub(super) is_timed: bool,
    /// The time of what was done of the job earlier [s].
    pub(super) done: f64,
    /// Its size and its turn.
    pub(super) size: Size,
}

/// How a drawing differs from its file, but for its place.
#[derive(Clone, Copy)]
pub(super) struct Size {
    /// Metres in the plane per metre in the file.
    pub(super) scale: f64,
    /// The angle by which it is turned, counter-clockwise [rad].
    pub(super) turn: f64,
}

impl Size {
    /// As the file has it.
    pub(super) const TRUE: Self = Self {
        scale: 1.0,
        turn: 0.0,
    };
}

impl ParsedJob {
    pub(super) fn new(
        name: String,
        text: Arc<Shelved<String>>,
        (mut job, size): (Job, Size),
        moves: &[Move],
    ) -> Self {
        let shelved = Arc::new(Shelved::of(&job));
        let changes = |action| matches!(action, Action::ChangeMode(_) | Action::Cross { .. });
        job.steps.retain(|step| changes(step.action));
        job.steps.shrink_to_fit();
        let (parts, pauses) = job.with_pauses(&divided(None, moves));
        let times = times(&parts);
        let packed = Arc::new(Packed::of(moves));
        let parts = if parts.len() == moves.len() {
            Arc::clone(&packed)
        } else {
            Arc::new(Packed::of(&parts))
        };
        Self {
            name,
            text,
            outline: Arc::new(job),
            job: shelved,
            pauses: pauses.into(),
            moves: packed,
            times,
            is_timed: false,
            pieces: Arc::clone(&parts),
            part_of: None,
            parts,
            done: 0.0,
            size,
        }
    }

    /// The same job with the times that the controller's planner takes from a start on, planned while `goes_on`
    /// returns true; none if it cannot be planned.
    pub(super) fn timed(
        &self,
        preview: &Preview,
        start: JobStart,
        goes_on: &dyn Fn() -> bool,
    ) -> Option<Self> {
        let start = preview.plan_start(start)?;
        let times = planned_times(preview.settings(), start, &self.pieces.unpacked(), goes_on)?;
        Some(Self {
            times: times.into(),
            is_timed: true,
            ..self.clone()
        })
    }

    /// The parts between its pauses; none if it has no pause.
    pub(super) fn layers(&self) -> Vec<Layer> {
        if self.pauses.is_empty() {
            return Vec::new();
        }
        let first = self.outline.stops.iter().find(|stop| stop.before == 0);
        let first = first.map_or_else(|| "The beginning".into(), ToString::to_string);
        let names = std::iter::once(first).chain(self.pauses.iter().map(|it| it.text.clone()));
        let ends = self.pauses.iter().map(|pause| pause.before);
        let ends = ends.chain([self.parts.len()]);
        let (mut begins, mut place) = (0, None);
        let mut parts = self.parts.iter();
        let layers = names.zip(ends).take(MOST_LAYERS).map(|(name, ends)| {
            let mut layer = Layer {
                name: brief(name),
                strokes: 0,
                length: 0.0,
            };
            let mut was_down = false;
            for next in parts.by_ref().take(ends - begins) {
                let is_down = next.tool > 0;
                if is_down {
                    layer.strokes += usize::from(!was_down);
                    layer.length += length(place, &next);
                }
                was_down = is_down;
                place = end(&next).or(place);
            }
            begins = ends;
            layer
        });
        layers.collect()
    }

    /// The planned time of the job [s].
    pub(super) fn time(&self) -> Option<f64> {
        self.times.last().copied().filter(|_| self.is_timed)
    }

    /// The same job by time-optimal motion from a start on; why not, as a sentence.
    pub(super) fn planned(
        &self,
        planner: &JobPlanner,
        preview: &Preview,
        start: JobStart,
    ) -> Result<Self, String> {
        let from = start.tool().ok_or("The arm's position is unknown.")?;
        let checks = preview.planner(start);
        let mut checks = checks.map_err(|error| error.to_string())?;
        let planned = planner.plan(from, &self.parts.unpacked(), &mut checks);
        let planned = planned.map_err(|error| format!("Time-optimal motion: {error}."))?;
        let pieces: Vec<Move> = planned.iter().map(|planned| planned.next).collect();
        let source = planned.iter().map(|planned| planned.source.unwrap_or(0));
        Ok(Self {
            part_of: Some(source.collect()),
            times: times(&pieces),
            pieces: Arc::new(Packed::of(&pieces)),
            ..self.clone()
        })
    }

    /// What remains of the job from a place on one of its parts on [m].
    pub(super) fn rest(&self, part: usize, place: [f32; 2]) -> Self {
        let mut rest = self.parts.from(part);
        let mut parts: Vec<Move> = Vec::new();
        let mut pauses = Vec::new();
        if let Some(first) = rest.next() {
            parts.extend(remaining(place, first));
            let ahead = self.pauses.iter().filter(|pause| pause.before > part);
            pauses.extend(ahead.map(|pause| Pause {
                before: pause.before - part - 1 + parts.len(),
                text: pause.text.clone(),
            }));
            parts.extend(rest);
        }
        let done = self.pieces_before(part.min(self.parts.len()));
        let done = done.checked_sub(1).map_or(0.0, |last| self.times[last]);
        let times = times(&parts);
        let parts = Arc::new(Packed::of(&parts));
        Self {
            pieces: Arc::clone(&parts),
            part_of: None,
            times,
            is_timed: false,
            parts,
            pauses: pauses.into(),
            done: self.done + done,
            ..self.clone()
        }
    }

    /// The part that the piece with this number belongs to.
    pub(super) fn part(&self, piece: usize) -> usize {
        match &self.part_of {
            Some(part_of) => part_of.get(piece).copied().unwrap_or(self.parts.len()),
            None => piece.min(self.parts.len()),
        }
    }

    /// The number of pieces of the parts before this one.
    fn pieces_before(&self, part: usize) -> usize {
        match &self.part_of {
            Some(part_of) => part_of.partition_point(|&of| of < part),
            None => part.min(self.pieces.len()),
        }
    }

    /// The first pause behind this number of pieces: the number of pieces before it, and its text. None if
    /// the job goes on to its end.
    pub(super) fn next_pause(&self, pieces: usize) -> Option<(usize, &str)> {
        let mut pauses = self
            .pauses
            .iter()
            .map(|pause| (self.pieces_before(pause.before), pause.text.as_str()));
        pauses.find(|&(before, _)| before > pieces)
    }

    /// The first part of this line or of one behind it, and where the tool is before it [m]; none if
    /// no move is.
    pub(super) fn at_line(&self, line: u32) -> Option<(usize, Option<[f32; 2]>)> {
        let mut place = None;
        for (index, next) in self.parts.iter().enumerate() {
            if next.tag >= line {
                return Some((index, place));
            }
            place = end(&next).or(place);
        }
        None
    }
}

fn times(pieces: &[Move]) -> Arc<[f64]> {
    let (mut place, mut time) = (None, 0.0);
    let times = pieces.iter().map(|next| {
        time += duration(place, next);
        place = end(next).or(place);
        time
    });
    times.collect()
}
