//! A job that was read: its moves, and what the controller gets of them.

use super::preview::{JobStart, Preview};
use fivebar_files::job::{Job, Pause};
use fivebar_firmware::Move;
use fivebar_sim::path_queue::{divided, duration, end, remaining};
use fivebar_sim::time_optimal::JobPlanner;
use std::sync::Arc;

/// A job that was read.
pub(super) struct ParsedJob {
    pub(super) name: String,
    pub(super) job: Arc<Job>,
    pub(super) moves: Arc<[Move]>,
    /// The moves in parts short enough for a new share of the feed rate to take effect soon.
    parts: Vec<Move>,
    /// Where it waits for its user, among the parts.
    pauses: Vec<Pause>,
    /// What the controller gets: the parts, or a time-optimal motion along them.
    pub(super) pieces: Vec<Move>,
    /// The part that each piece belongs to.
    part_of: Vec<usize>,
    /// The time from the start to the end of each piece, at its feed rate [s].
    pub(super) times: Vec<f64>,
    /// The time of what was done of the job earlier [s].
    pub(super) done: f64,
}

impl ParsedJob {
    pub(super) fn new(name: String, job: Job, moves: Vec<Move>) -> Self {
        let (parts, pauses) = job.with_pauses(&divided(None, &moves));
        let mut parsed = Self {
            name,
            job: Arc::new(job),
            pauses,
            moves: moves.into(),
            pieces: parts.clone(),
            part_of: (0..parts.len()).collect(),
            parts,
            times: Vec::new(),
            done: 0.0,
        };
        parsed.times = times(&parsed.pieces);
        parsed
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
        let planned = planner.plan(from, &self.parts, &mut checks);
        let planned = planned.map_err(|error| format!("Time-optimal motion: {error}."))?;
        let pieces: Vec<Move> = planned.iter().map(|planned| planned.next).collect();
        let source = planned.iter().map(|planned| planned.source.unwrap_or(0));
        Ok(Self {
            name: self.name.clone(),
            job: Arc::clone(&self.job),
            moves: Arc::clone(&self.moves),
            parts: self.parts.clone(),
            pauses: self.pauses.clone(),
            part_of: source.collect(),
            times: times(&pieces),
            pieces,
            done: self.done,
        })
    }

    /// What remains of the job from a place on one of its parts on [m].
    pub(super) fn rest(&self, part: usize, place: [f32; 2]) -> Self {
        let (before, rest) = self.parts.split_at(part.min(self.parts.len()));
        let mut parts: Vec<Move> = Vec::with_capacity(rest.len() + 1);
        let mut pauses = Vec::new();
        if let Some((first, others)) = rest.split_first() {
            parts.extend(remaining(place, *first));
            let ahead = self.pauses.iter().filter(|pause| pause.before > part);
            pauses.extend(ahead.map(|pause| Pause {
                before: pause.before - part - 1 + parts.len(),
                text: pause.text.clone(),
            }));
            parts.extend(others);
        }
        let done = self.part_of.partition_point(|&of| of < before.len());
        let done = done.checked_sub(1).map_or(0.0, |last| self.times[last]);
        Self {
            name: self.name.clone(),
            job: Arc::clone(&self.job),
            moves: Arc::clone(&self.moves),
            pieces: parts.clone(),
            part_of: (0..parts.len()).collect(),
            times: times(&parts),
            parts,
            pauses,
            done: self.done + done,
        }
    }

    /// The part that the piece with this number belongs to.
    pub(super) fn part(&self, piece: usize) -> usize {
        self.part_of.get(piece).copied().unwrap_or(self.parts.len())
    }

    /// The first pause behind this number of pieces: the number of pieces before it, and its text. None if
    /// the job goes on to its end.
    pub(super) fn next_pause(&self, pieces: usize) -> Option<(usize, &str)> {
        let mut pauses = self.pauses.iter().map(|pause| {
            let before = self.part_of.partition_point(|&part| part < pause.before);
            (before, pause.text.as_str())
        });
        pauses.find(|&(before, _)| before > pieces)
    }

    /// The first part of this line or of one behind it, and where the tool is before it [m]; none if
    /// no move is.
    pub(super) fn at_line(&self, line: u32) -> Option<(usize, Option<[f32; 2]>)> {
        let index = self.parts.iter().position(|next| next.tag >= line)?;
        let place = self.parts[..index].iter().rev().find_map(end);
        Some((index, place))
    }
}

fn times(pieces: &[Move]) -> Vec<f64> {
    let (mut place, mut time) = (None, 0.0);
    let times = pieces.iter().map(|next| {
        time += duration(place, next);
        place = end(next).or(place);
        time
    });
    times.collect()
}
