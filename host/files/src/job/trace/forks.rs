//! Branches of thinned ink become lines: at a fork, the two that go on straightest are one line, then the next two.
//!
//! Near a fork and near an end, thinned ink does not show the middle: where two lines cross, it has two forks side by side, and
//! at an end it leads to a corner. There, as far as the ink is deep, a line goes straight on instead.

use super::Stroke;
use std::collections::BTreeMap;

/// The direction of a branch is that of so many pixels behind what is left out.
const FAR: usize = 8;
/// Branches that turn by more than this are two lines (cos 50°).
const STRAIGHT: f64 = 0.64;

/// What a branch meets at its end.
#[derive(Clone, Copy)]
pub(super) struct Node {
    /// The pixel.
    pub(super) at: usize,
    pub(super) is_fork: bool,
}

/// The middles of the pixels of a line between two nodes.
pub(super) struct Branch {
    pub(super) ends: [Node; 2],
    pub(super) points: Stroke,
    /// How deep each pixel lies in the ink [pixels].
    pub(super) depths: Vec<usize>,
}

impl Branch {
    /// Whether it only lies between the two forks of one crossing.
    fn is_bridge(&self) -> bool {
        let [first, last] = self.ends;
        first.is_fork
            && last.is_fork
            && first.at != last.at
            && self.points.len() <= self.hidden(0).max(self.hidden(1)) + 1
    }

    /// The points from an end on.
    fn points_from(&self, end: usize) -> Stroke {
        match end {
            0 => self.points.clone(),
            _ => self.points.iter().rev().copied().collect(),
        }
    }

    /// How far from an end the line is hidden by the depth of the ink [pixels].
    fn hidden(&self, end: usize) -> usize {
        let last = self.depths.len() - 1;
        let is_clear = |&along: &usize| self.depth(end, along) <= along;
        (0..=last).find(is_clear).unwrap_or(last)
    }

    /// The depth so many pixels from an end.
    fn depth(&self, end: usize, along: usize) -> usize {
        let last = self.depths.len() - 1;
        self.depths[if end == 0 { along } else { last - along }]
    }

    /// Of an end: the points that are left out, and the direction of the branch there, away from the end.
    fn heading(&self, end: usize) -> (usize, [f64; 2]) {
        let points = self.points_from(end);
        let last = points.len() - 1;
        let skipped = self.hidden(end).min(last / 3);
        let [from, to] = [skipped, (skipped + FAR).min(last)].map(|at| points[at]);
        let [x, y] = [to[0] - from[0], to[1] - from[1]];
        let length = x.hypot(y).max(f64::MIN_POSITIVE);
        (skipped, [x / length, y / length])
    }
}

/// The lines that the branches make.
pub(super) fn lines(branches: Vec<Branch>) -> Vec<Stroke> {
    let mut clusters = Clusters::of(&branches);
    let branches: Vec<Branch> = branches.into_iter().filter(|it| !it.is_bridge()).collect();
    let partner = partners(&branches, &mut clusters);
    let mut is_done = vec![false; branches.len()];
    let mut lines = Vec::new();
    // Lines with an end first, then closed ones. Number 2 n is the first end of branch n, 2 n + 1 its last one.
    let begins = (0..partner.len()).filter(|&it| partner[it].is_none());
    for begin in begins.chain(0..partner.len()) {
        let mut line: Stroke = Vec::new();
        let mut from = begin;
        while !is_done[from / 2] {
            is_done[from / 2] = true;
            line.extend(straightened(
                &branches[from / 2],
                from % 2,
                [from, from ^ 1].map(|it| partner[it].is_some()),
            ));
            let Some(next) = partner[from ^ 1] else {
                break;
            };
            from = next;
        }
        if partner[begin].is_some() && from == begin {
            line.extend(line.first().copied());
        }
        if !line.is_empty() {
            lines.push(line);
        }
    }
    lines
}

/// Forks with a bridge between them are one node: each fork leads to another one, and the last stands for all.
#[derive(Default)]
struct Clusters(BTreeMap<usize, usize>);

impl Clusters {
    fn of(branches: &[Branch]) -> Self {
        let mut clusters = Self::default();
        for bridge in branches.iter().filter(|it| it.is_bridge()) {
            let [first, last] = bridge.ends.map(|node| clusters.node(node.at));
            if first != last {
                clusters.0.insert(last, first);
            }
        }
        clusters
    }

    fn node(&mut self, at: usize) -> usize {
        let mut root = at;
        while let Some(&next) = self.0.get(&root) {
            root = next;
        }
        // The next search is short.
        let mut at = at;
        while at != root {
            at = self.0.insert(at, root).unwrap_or(root);
        }
        root
    }
}

/// The end of a branch with which each end goes on.
fn partners(branches: &[Branch], clusters: &mut Clusters) -> Vec<Option<usize>> {
    let mut ends: Vec<(usize, usize, [f64; 2])> = Vec::new();
    for (number, branch) in branches
        .iter()
        .enumerate()
        .filter(|(_, it)| it.points.len() > 1)
    {
        for end in [0, 1] {
            let node = clusters.node(branch.ends[end].at);
            ends.push((node, 2 * number + end, branch.heading(end).1));
        }
    }
    ends.sort_by_key(|&(node, number, _)| (node, number));
    let mut partner = vec![None; 2 * branches.len()];
    for meeting in ends.chunk_by(|a, b| a.0 == b.0) {
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (index, &(_, a, u)) in meeting.iter().enumerate() {
            let others = &meeting[index + 1..];
            pairs.extend(
                others
                    .iter()
                    .map(|&(_, b, v)| (-(u[0] * v[0] + u[1] * v[1]), a, b)),
            );
        }
        pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (straight, a, b) in pairs {
            let is_free = partner[a].is_none() && partner[b].is_none();
            if is_free && (straight > STRAIGHT || meeting.len() == 2) {
                (partner[a], partner[b]) = (Some(b), Some(a));
            }
        }
    }
    partner
}

/// The points of a branch from one end to the other; `goes_on` says at which of them the line does. There, what the ink hides
/// is left out; at a free end it becomes straight.
fn straightened(branch: &Branch, from: usize, goes_on: [bool; 2]) -> Stroke {
    let mut points = branch.points_from(from);
    let is_ring = branch.ends[0].at == branch.ends[1].at;
    if points.len() < 2 || is_ring && !branch.ends[0].is_fork {
        return points;
    }
    let ends = [from, 1 - from];
    let headings = ends.map(|end| branch.heading(end));
    let [first, last] = [0, 1].map(|side| {
        let node = branch.ends[ends[side]];
        let is_corrected = goes_on[side] || !node.is_fork;
        if is_corrected { headings[side].0 } else { 0 }
    });
    let end_of = |points: &Stroke, side: usize| {
        if side == 0 {
            points[0]
        } else {
            points[points.len() - 1]
        }
    };
    let old_ends = [0, 1].map(|side| end_of(&points, side));
    let kept = points.len() - last;
    points.truncate(kept);
    points.drain(..first);
    for (side, skipped) in [first, last].into_iter().enumerate() {
        let node = branch.ends[ends[side]];
        if skipped == 0 || node.is_fork {
            continue;
        }
        let here = end_of(&points, side);
        let direction = headings[side].1;
        let [x, y] = [here[0] - old_ends[side][0], here[1] - old_ends[side][1]];
        // The ink ends as far behind the old end as it is deep there; a pen as wide as the ink ends half its width before.
        let depths = [0, skipped].map(|along| branch.depth(ends[side], along) as f64);
        let along = x * direction[0] + y * direction[1] + depths[0] - depths[1];
        let along = along.max(0.0);
        let new_end = [
            here[0] - along * direction[0],
            here[1] - along * direction[1],
        ];
        match side {
            0 => points.insert(0, new_end),
            _ => points.push(new_end),
        }
    }
    points
}
