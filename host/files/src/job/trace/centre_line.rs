//! Centre lines: what is dark is made thinner until lines of one pixel are left, and these become strokes.
//!
//! In each round one layer is peeled off, from each of the four sides in turn. A pixel is only taken away if the ink around it
//! stays in one piece and no hole opens (a simple point), and if it is no end of a line. So the lines have as many parts and holes
//! as the ink.

use super::Stroke;
use super::forks::{Branch, Node, lines};
use super::raster::Raster;
use super::simplify::{simplified, smoothed};
use crate::budget::{Budget, OverBudget};

/// Greatest distance of what is drawn from the smoothed line of pixels.
const TOLERANCE: f64 = 0.3;
/// A branch that is no longer than the ink is deep at its root, and this [pixels], is none of the drawing.
const SPUR: usize = 2;
/// Points that the budget has for each branch.
const MOST_OF_A_BRANCH: usize = 5;
/// Such branches are searched at most so often: one that is left has been part of a longer one.
const SPUR_ROUNDS: usize = 3;
/// The eight neighbours, clockwise from the right.
const AROUND: [[i64; 2]; 8] = [
    [1, 0],
    [1, 1],
    [0, 1],
    [-1, 1],
    [-1, 0],
    [-1, -1],
    [0, -1],
    [1, -1],
];

/// The centre lines of what is darker than the level.
pub(super) fn strokes(raster: &Raster, level: f32) -> Result<Vec<Stroke>, OverBudget> {
    let mut ink = Ink::new(raster, level);
    ink.thin();
    for _ in 0..SPUR_ROUNDS {
        if !ink.has_lost_spurs() {
            break;
        }
        ink.thin();
    }
    let mut budget = Budget::points();
    let branches = ink.branches();
    Budget::points().take(MOST_OF_A_BRANCH * branches.len())?;
    let branches = branches.into_iter().map(|pixels| Branch {
        ends: [pixels.first(), pixels.last()].map(|at| ink.node(at.copied().unwrap_or(0))),
        depths: pixels
            .iter()
            .map(|&at| usize::from(ink.depth[at]))
            .collect(),
        points: pixels.into_iter().map(|at| ink.place(at)).collect(),
    });
    let lines = lines(branches.collect());
    let mut strokes = Vec::with_capacity(lines.len());
    for line in lines {
        let is_closed = line.len() > 2 && line.first() == line.last();
        let mut points = match line[..] {
            // A dot is a line of half a pixel.
            [[x, y]] => vec![[x - 0.25, y], [x + 0.25, y]],
            _ => line,
        };
        if is_closed {
            points.pop();
        }
        points = smoothed(&smoothed(&points, is_closed), is_closed);
        if is_closed {
            points.extend(points.first().copied());
        }
        let points = simplified(&points, TOLERANCE);
        budget.take(points.len())?;
        strokes.push(points);
    }
    Ok(strokes)
}

/// Pixels with ink, in a white frame.
struct Ink {
    width: usize,
    is_ink: Vec<bool>,
    /// The round in which a pixel was at the edge: how deep it lies in the ink [pixels].
    depth: Vec<u16>,
    edge: Vec<usize>,
}

impl Ink {
    fn new(raster: &Raster, level: f32) -> Self {
        let width = raster.width() + 2;
        let is_ink: Vec<bool> = (0..raster.height() + 2)
            .flat_map(|row| (0..width).map(move |column| [column as i64 - 1, row as i64 - 1]))
            .map(|[x, y]| raster.at(x, y) > level)
            .collect();
        let mut ink = Self {
            width,
            depth: vec![0; is_ink.len()],
            edge: Vec::new(),
            is_ink,
        };
        let pixels = (0..ink.is_ink.len()).filter(|&at| ink.is_ink[at]);
        ink.edge = pixels.filter(|&at| ink.is_at_edge(at)).collect();
        for &at in &ink.edge {
            ink.depth[at] = 1;
        }
        ink
    }

    /// Makes the ink thinner until nothing can be taken away.
    fn thin(&mut self) {
        loop {
            let mut taken = Vec::new();
            for side in [6, 2, 0, 4] {
                let layer: Vec<usize> = self
                    .edge
                    .iter()
                    .copied()
                    .filter(|&at| self.is_ink[at] && !self.is_ink[self.beside(at, side)])
                    .collect();
                for at in layer {
                    if self.is_simple(at) && self.neighbours(at) > 1 {
                        self.is_ink[at] = false;
                        taken.push(at);
                    }
                }
            }
            if taken.is_empty() {
                return;
            }
            self.edge.retain(|&at| self.is_ink[at]);
            for at in taken {
                for side in 0..8 {
                    let beside = self.beside(at, side);
                    if self.is_ink[beside] && self.depth[beside] == 0 {
                        self.depth[beside] = self.depth[at].saturating_add(1);
                        self.edge.push(beside);
                    }
                }
            }
        }
    }

    fn beside(&self, at: usize, side: usize) -> usize {
        let [x, y] = AROUND[side];
        at.wrapping_add_signed(y as isize * self.width as isize + x as isize)
    }

    fn is_at_edge(&self, at: usize) -> bool {
        [0, 2, 4, 6]
            .iter()
            .any(|&side| !self.is_ink[self.beside(at, side)])
    }

    fn neighbours(&self, at: usize) -> usize {
        (0..8)
            .filter(|&side| self.is_ink[self.beside(at, side)])
            .count()
    }

    /// Whether the ink around a pixel is one piece and the white beside it, too (S. Yokoi's number is 1).
    fn is_simple(&self, at: usize) -> bool {
        let white: [bool; 8] = std::array::from_fn(|side| !self.is_ink[self.beside(at, side)]);
        let begins =
            |&side: &usize| white[side] && !(white[(side + 1) % 8] && white[(side + 2) % 8]);
        [0, 2, 4, 6].iter().filter(|&side| begins(side)).count() == 1
    }

    /// The neighbours to which a line goes on: a diagonal one only if no pixel beside both leads there.
    fn linked(&self, at: usize) -> impl Iterator<Item = usize> + '_ {
        let is_ink = move |side: usize| self.is_ink[self.beside(at, side % 8)];
        let sides = (0..8).filter(move |&side| {
            is_ink(side) && (side % 2 == 0 || !is_ink(side + 1) && !is_ink(side + 7))
        });
        sides.map(move |side| self.beside(at, side))
    }

    /// The pixels of each line between ends and forks, these included, and of each closed line.
    fn branches(&self) -> Vec<Vec<usize>> {
        let is_node = |at: usize| self.linked(at).count() != 2;
        let mut is_done = vec![false; self.is_ink.len()];
        let mut branches = Vec::new();
        let pixels = || (0..self.is_ink.len()).filter(|&at| self.is_ink[at]);
        for node in pixels().filter(|&at| is_node(at)) {
            if self.linked(node).next().is_none() {
                branches.push(vec![node]);
            }
            for first in self.linked(node) {
                // Between two nodes side by side, the one with the lower number begins.
                if is_done[first] || is_node(first) && first < node {
                    continue;
                }
                branches.push(self.followed(node, first, &is_node, &mut is_done));
            }
        }
        for at in pixels().filter(|&at| !is_node(at)) {
            if !is_done[at]
                && let Some(first) = self.linked(at).next()
            {
                is_done[at] = true;
                branches.push(self.followed(at, first, &|it| it == at, &mut is_done));
            }
        }
        branches
    }

    /// The pixels from one to the next node.
    fn followed(
        &self,
        from: usize,
        first: usize,
        is_node: &dyn Fn(usize) -> bool,
        is_done: &mut [bool],
    ) -> Vec<usize> {
        let mut line = vec![from, first];
        let (mut before, mut at) = (from, first);
        while !is_node(at) {
            is_done[at] = true;
            let Some(next) = self.linked(at).find(|&next| next != before) else {
                break;
            };
            line.push(next);
            (before, at) = (at, next);
        }
        line
    }

    /// Takes away branches that only reach from the middle of the ink to its edge; whether there were any.
    fn has_lost_spurs(&mut self) -> bool {
        let mut lost = false;
        for branch in self.branches() {
            let [Some(&first), Some(&last)] = [branch.first(), branch.last()] else {
                continue;
            };
            let ends = [first, last].map(|at| self.linked(at).count());
            let root = match ends {
                [1, 3..=8] => last,
                [3..=8, 1] => first,
                _ => continue,
            };
            if branch.len() <= usize::from(self.depth[root]) + SPUR {
                for at in branch.into_iter().filter(|&at| at != root) {
                    self.is_ink[at] = false;
                    lost = true;
                }
            }
        }
        if lost {
            self.edge.retain(|&at| self.is_ink[at]);
        }
        lost
    }

    /// What a branch meets at its end.
    fn node(&self, at: usize) -> Node {
        Node {
            at,
            is_fork: self.linked(at).count() > 2,
        }
    }

    /// The middle of a pixel, without the frame.
    fn place(&self, at: usize) -> [f64; 2] {
        let [column, row] = [at % self.width, at / self.width];
        [column as f64 - 0.5, row as f64 - 0.5]
    }
}
