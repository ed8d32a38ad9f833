//! The order of strokes: each stroke is followed by the one with the nearest end, which is drawn
//! from there.
//!
//! The ends lie in a tree that halves them by x and y in turns. It is halved by their number, so that it
//! stays flat wherever they lie: a grid would hold thousands of strokes at one point in one cell.

use super::drawing::Stroke;
use std::cmp::Ordering;
use std::ops::Range;

/// The strokes with the one nearest to `from` first.
pub(super) fn sorted(mut strokes: Vec<Stroke>, from: [f64; 2]) -> Vec<Stroke> {
    strokes.retain(|stroke| !stroke.is_empty());
    let mut tree = EndTree::new(&strokes);
    let mut at = from;
    let mut sorted = Vec::with_capacity(strokes.len());
    while let Some(End {
        stroke, is_last, ..
    }) = tree.take_nearest(at)
    {
        let mut stroke = std::mem::take(&mut strokes[stroke]);
        if is_last {
            stroke.reverse();
        }
        at = stroke.last().copied().unwrap_or(at);
        sorted.push(stroke);
    }
    sorted
}

/// An end of a stroke.
#[derive(Clone, Copy)]
struct End {
    stroke: usize,
    /// Whether it is the last point.
    is_last: bool,
    at: [f64; 2],
}

/// The ends of the strokes that are not taken yet.
struct EndTree {
    /// The middle of each range is a node: before it lie ends with a smaller x, or y, behind it the others.
    ends: Vec<End>,
    /// How many ends are left in the range of each node.
    left: Vec<usize>,
    /// The nodes of both ends of each stroke.
    nodes: Vec<[usize; 2]>,
    is_taken: Vec<bool>,
}

impl EndTree {
    fn new(strokes: &[Stroke]) -> Self {
        let mut ends = Vec::with_capacity(2 * strokes.len());
        for (stroke, points) in strokes.iter().enumerate() {
            let both = [(points.first(), false), (points.last(), true)];
            for (at, is_last) in both {
                ends.extend(at.map(|&at| End {
                    stroke,
                    is_last,
                    at,
                }));
            }
        }
        let mut left = vec![0; ends.len()];
        halve(&mut ends, &mut left, 0);
        let mut nodes = vec![[0; 2]; strokes.len()];
        for (node, end) in ends.iter().enumerate() {
            nodes[end.stroke][usize::from(end.is_last)] = node;
        }
        Self {
            ends,
            left,
            nodes,
            is_taken: vec![false; strokes.len()],
        }
    }

    /// Takes the stroke with the end nearest to `at`.
    fn take_nearest(&mut self, at: [f64; 2]) -> Option<End> {
        let mut best = None;
        self.search(0..self.ends.len(), 0, at, &mut best);
        let (_, end) = best?;
        self.is_taken[end.stroke] = true;
        for node in self.nodes[end.stroke] {
            let mut range = 0..self.ends.len();
            loop {
                let middle = range.start + range.len() / 2;
                self.left[middle] -= 1;
                match node.cmp(&middle) {
                    Ordering::Less => range.end = middle,
                    Ordering::Equal => break,
                    Ordering::Greater => range.start = middle + 1,
                }
            }
        }
        Some(end)
    }

    /// Looks for a nearer end in a range, which is halved along `axis`.
    fn search(
        &self,
        range: Range<usize>,
        axis: usize,
        at: [f64; 2],
        best: &mut Option<(f64, End)>,
    ) {
        let middle = range.start + range.len() / 2;
        if range.is_empty() || self.left[middle] == 0 {
            return;
        }
        let end = self.ends[middle];
        let is_nearer =
            |far: f64, best: &Option<(f64, End)>| best.is_none_or(|(nearest, _)| far < nearest);
        let far = (at[0] - end.at[0]).hypot(at[1] - end.at[1]);
        if !self.is_taken[end.stroke] && is_nearer(far, best) {
            *best = Some((far, end));
        }
        let beyond = at[axis] - end.at[axis];
        let (near, other) = if beyond < 0.0 {
            (range.start..middle, middle + 1..range.end)
        } else {
            (middle + 1..range.end, range.start..middle)
        };
        self.search(near, 1 - axis, at, best);
        if is_nearer(beyond.abs(), best) {
            self.search(other, 1 - axis, at, best);
        }
    }
}

/// Sorts the ends of a range into a tree.
fn halve(ends: &mut [End], left: &mut [usize], axis: usize) {
    if ends.is_empty() {
        return;
    }
    let middle = ends.len() / 2;
    left[middle] = ends.len();
    ends.select_nth_unstable_by(middle, |a, b| a.at[axis].total_cmp(&b.at[axis]));
    let (before, behind) = ends.split_at_mut(middle);
    let (left_before, left_behind) = left.split_at_mut(middle);
    halve(before, left_before, 1 - axis);
    halve(&mut behind[1..], &mut left_behind[1..], 1 - axis);
}

#[cfg(test)]
mod tests {
    use super::sorted;

    #[test]
    fn each_stroke_is_followed_by_the_one_with_the_nearest_end() {
        // A grid of dashes in a scattered order, some of them backwards.
        let dash = |index: usize| {
            let at = (index * 7919) % 900;
            let (x, y) = ((at % 30) as f64 * 1e-2, (at / 30) as f64 * 1e-2);
            let ends = [[x, y], [x + 7e-3, y + 1e-3]];
            if index.is_multiple_of(3) {
                vec![ends[1], ends[0]]
            } else {
                ends.to_vec()
            }
        };
        let strokes: Vec<_> = (0..900).map(dash).collect();
        let far = |[a, b]: [f64; 2], [c, d]: [f64; 2]| (a - c).hypot(b - d);
        let mut left = strokes.clone();
        let mut at = [0.0; 2];
        for stroke in sorted(strokes, [0.0; 2]) {
            let start = stroke[0];
            let nearest = left
                .iter()
                .flat_map(|it| [it[0], it[1]])
                .map(|end| far(at, end));
            let nearest = nearest.fold(f64::MAX, f64::min);
            assert!(
                (far(at, start) - nearest).abs() < 1e-12,
                "{start:?} from {at:?}"
            );
            let index = left
                .iter()
                .position(|it| it.contains(&start) && it.contains(&stroke[1]));
            left.swap_remove(index.unwrap());
            at = stroke[1];
        }
        assert!(left.is_empty());
    }

    #[test]
    fn strokes_that_lie_on_each_other_are_sorted_as_fast_as_others() {
        let apart = |index: u32| [f64::from(index % 200), f64::from(index / 200)];
        let point = |_| [0.0, 0.0];
        // All but one of a drawing in a spot of it.
        let spot = |index: u32| apart(index).map(|x| if index == 0 { 1e6 } else { 1e-3 * x });
        let places: [&dyn Fn(u32) -> [f64; 2]; 3] = [&apart, &point, &spot];
        let took = places.map(|place| {
            let stroke = |index| vec![place(index), place(index).map(|x| x + 1e-4)];
            let strokes: Vec<_> = (0..20_000).map(stroke).collect();
            let started = std::time::Instant::now();
            assert_eq!(sorted(strokes, [0.0; 2]).len(), 20_000);
            started.elapsed()
        });
        assert!(took[1].max(took[2]) < 20 * took[0], "{took:?}");
    }
}
