//! The order of strokes: each stroke is followed by the one with the nearest end, which is drawn
//! from there. Then parts of the order are turned round where that saves travel.
//!
//! The ends lie in a tree that halves them by x and y in turns. It is halved by their number, so that it
//! stays flat wherever they lie: a grid would hold thousands of strokes at one point in one cell.

use super::drawing::Stroke;
use std::cmp::Ordering;
use std::ops::Range;

/// How many exchanges are tried at most: a second of work where this is not optimised.
const MOST_TRIED: usize = 20_000_000;
/// Most strokes whose order is turned at once.
const MOST_TURNED: usize = 1000;
/// An exchange that saves less is not worth it [m].
const LEAST_SAVED: f64 = 1e-9;

/// Orders the strokes of one pen after the other.
#[derive(Default)]
pub(super) struct Order {
    /// Exchanges that were tried, of all pens, and strokes that were turned for them.
    tried: usize,
}

impl Order {
    /// The strokes with the one nearest to `from` first, and then in an order with less travel.
    pub(super) fn sorted(&mut self, mut strokes: Vec<Stroke>, from: [f64; 2]) -> Vec<Stroke> {
        strokes.retain(|stroke| !stroke.is_empty());
        let mut order = nearest_first(&strokes, from);
        shorten(&mut order, from, &mut self.tried);
        order
            .into_iter()
            .map(|drawn| {
                let mut stroke = std::mem::take(&mut strokes[drawn.stroke]);
                if drawn.is_reversed {
                    stroke.reverse();
                }
                stroke
            })
            .collect()
    }
}

/// A stroke as it is drawn.
#[derive(Clone, Copy)]
struct Drawn {
    stroke: usize,
    is_reversed: bool,
    /// Where it begins and ends.
    ends: [[f64; 2]; 2],
}

impl Drawn {
    fn reversed(self) -> Self {
        let [first, last] = self.ends;
        Self {
            is_reversed: !self.is_reversed,
            ends: [last, first],
            ..self
        }
    }
}

/// Each stroke is followed by the one with the nearest end.
fn nearest_first(strokes: &[Stroke], from: [f64; 2]) -> Vec<Drawn> {
    let mut tree = EndTree::new(strokes);
    let mut at = from;
    let mut order = Vec::with_capacity(strokes.len());
    while let Some(End {
        stroke, is_last, ..
    }) = tree.take_nearest(at)
    {
        let points = &strokes[stroke];
        let [first, last] = [points.first(), points.last()].map(|p| p.copied().unwrap_or(at));
        let drawn = Drawn {
            stroke,
            is_reversed: false,
            ends: [first, last],
        };
        let drawn = if is_last { drawn.reversed() } else { drawn };
        at = drawn.ends[1];
        order.push(drawn);
    }
    order
}

/// Turns parts of the order round, with their strokes, as long as that saves travel (2-opt).
fn shorten(order: &mut [Drawn], from: [f64; 2], tried: &mut usize) {
    let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let mut has_saved = true;
    while has_saved {
        has_saved = false;
        for first in 0..order.len() {
            let before = first.checked_sub(1).map_or(from, |at| order[at].ends[1]);
            for last in first..order.len().min(first + MOST_TURNED) {
                let [begin, end] = [order[first].ends[0], order[last].ends[1]];
                let to_after = |at| {
                    order
                        .get(last + 1)
                        .map_or(0.0, |next| distance(at, next.ends[0]))
                };
                let now = distance(before, begin) + to_after(end);
                let turned = distance(before, end) + to_after(begin);
                if turned < now - LEAST_SAVED {
                    let part = &mut order[first..=last];
                    *tried += part.len();
                    part.reverse();
                    for drawn in part {
                        *drawn = drawn.reversed();
                    }
                    has_saved = true;
                }
            }
            *tried += MOST_TURNED.min(order.len() - first);
            if *tried > MOST_TRIED {
                return;
            }
        }
    }
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
    use super::{Order, nearest_first};
    use fivebar_design::Noise;

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
        for drawn in nearest_first(&strokes, [0.0; 2]) {
            let [start, end] = drawn.ends;
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
                .position(|it| it.contains(&start) && it.contains(&end));
            left.swap_remove(index.unwrap());
            at = end;
        }
        assert!(left.is_empty());
    }

    #[test]
    fn turning_parts_of_the_order_round_saves_travel_and_keeps_every_stroke() {
        let mut noise = Noise::new(5);
        let mut random = || [noise.uniform(), noise.uniform()];
        let strokes: Vec<_> = (0..300).map(|_| vec![random(), random()]).collect();
        let far = |[a, b]: [f64; 2], [c, d]: [f64; 2]| (a - c).hypot(b - d);
        let travel = |ends: &[[[f64; 2]; 2]]| {
            let gaps = ends.windows(2).map(|pair| far(pair[0][1], pair[1][0]));
            gaps.sum::<f64>() + far([0.0; 2], ends[0][0])
        };
        let nearest: Vec<_> = nearest_first(&strokes, [0.0; 2])
            .iter()
            .map(|drawn| drawn.ends)
            .collect();
        let sorted = Order::default().sorted(strokes.clone(), [0.0; 2]);
        let ends: Vec<_> = sorted.iter().map(|stroke| [stroke[0], stroke[1]]).collect();
        let (less, more) = (travel(&ends), travel(&nearest));
        assert!(less < 0.93 * more, "{less} {more}");
        // No part is left whose turn saves anything.
        for first in 0..ends.len() {
            for last in first..ends.len() {
                let mut turned = ends.clone();
                turned[first..=last].reverse();
                for ends in &mut turned[first..=last] {
                    ends.reverse();
                }
                assert!(travel(&turned) > less - 1e-6);
            }
        }
        let key = |stroke: &Vec<[f64; 2]>| {
            let mut stroke = stroke.clone();
            stroke.sort_by(|a, b| a[0].total_cmp(&b[0]));
            stroke
        };
        let [mut found, mut given] =
            [&sorted, &strokes].map(|all| all.iter().map(key).collect::<Vec<_>>());
        found.sort_by(|a, b| a[0][0].total_cmp(&b[0][0]));
        given.sort_by(|a, b| a[0][0].total_cmp(&b[0][0]));
        assert_eq!(found, given);
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
            assert_eq!(Order::default().sorted(strokes, [0.0; 2]).len(), 20_000);
            started.elapsed()
        });
        assert!(took[1].max(took[2]) < 20 * took[0], "{took:?}");
    }
}
