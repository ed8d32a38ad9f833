//! The order of strokes: each stroke is followed by the one with the nearest end, which is drawn
//! from there. The first one is nearest to (0, 0).
//!
//! The ends lie in a grid with about one stroke in a cell. Rings of cells around the tool are
//! searched until no cell further out can have a nearer end.

use super::Stroke;

pub(super) fn sorted(mut strokes: Vec<Stroke>) -> Vec<Stroke> {
    let mut grid = EndGrid::new(&strokes);
    let mut at = [0.0; 2];
    let mut sorted = Vec::with_capacity(strokes.len());
    while let Some((index, is_reversed)) = grid.take_nearest(at) {
        let mut stroke = std::mem::take(&mut strokes[index]);
        if is_reversed {
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

struct EndGrid {
    low: [f64; 2],
    /// Side of a cell [m].
    pitch: f64,
    /// Cells on each side.
    count: i64,
    cells: Vec<Vec<End>>,
    is_taken: Vec<bool>,
    left: usize,
}

impl EndGrid {
    fn new(strokes: &[Stroke]) -> Self {
        let ends: Vec<End> = strokes
            .iter()
            .enumerate()
            .flat_map(|(stroke, points)| {
                let ends = [(points.first(), false), (points.last(), true)];
                ends.into_iter().filter_map(move |(at, is_last)| {
                    Some(End {
                        stroke,
                        is_last,
                        at: *at?,
                    })
                })
            })
            .collect();
        let bound = |axis: usize, pick: fn(f64, f64) -> f64, first: f64| {
            ends.iter().map(|end| end.at[axis]).fold(first, pick)
        };
        let low = [0, 1].map(|axis| bound(axis, f64::min, f64::MAX));
        let high = [0, 1].map(|axis| bound(axis, f64::max, f64::MIN));
        let count = (strokes.len() as f64).sqrt().ceil().max(1.0);
        let size = (high[0] - low[0]).max(high[1] - low[1]);
        let mut grid = Self {
            low,
            pitch: (size / count).max(1e-9),
            count: count as i64,
            cells: vec![Vec::new(); (count * count) as usize],
            is_taken: vec![false; strokes.len()],
            left: strokes.len(),
        };
        for end in ends {
            let [column, row] = grid.cell(end.at);
            let index = (row * grid.count + column) as usize;
            grid.cells[index].push(end);
        }
        grid
    }

    /// The cell nearest to a point.
    fn cell(&self, at: [f64; 2]) -> [i64; 2] {
        [0, 1].map(|axis| {
            let cell = (at[axis] - self.low[axis]) / self.pitch;
            (cell as i64).clamp(0, self.count - 1)
        })
    }

    /// Takes the stroke with the end nearest to `at`; returns it and whether it is to be reversed.
    fn take_nearest(&mut self, at: [f64; 2]) -> Option<(usize, bool)> {
        if self.left == 0 {
            return None;
        }
        let [column, row] = self.cell(at);
        // How far outside the grid the point lies: a ring's cells may be nearer by this.
        let inside = [0, 1].map(|axis| {
            let high = self.low[axis] + self.pitch * self.count as f64;
            at[axis].clamp(self.low[axis], high)
        });
        let outside = distance(at, inside);
        let mut best: Option<(f64, End)> = None;
        for ring in 0..=self.count {
            let searched = (ring - 1).max(0) as f64 * self.pitch - outside;
            if best.is_some_and(|(nearest, _)| nearest <= searched) {
                break;
            }
            for y in row - ring..=row + ring {
                let step = if (y - row).abs() == ring { 1 } else { 2 * ring };
                let mut x = column - ring;
                while x <= column + ring {
                    self.search([x, y], at, &mut best);
                    x += step.max(1);
                }
            }
        }
        let (_, end) = best?;
        self.is_taken[end.stroke] = true;
        self.left -= 1;
        Some((end.stroke, end.is_last))
    }

    fn search(&mut self, [x, y]: [i64; 2], at: [f64; 2], best: &mut Option<(f64, End)>) {
        let is_inside = |cell: i64| (0..self.count).contains(&cell);
        if !is_inside(x) || !is_inside(y) {
            return;
        }
        let taken = &self.is_taken;
        let cell = &mut self.cells[(y * self.count + x) as usize];
        cell.retain(|end| !taken[end.stroke]);
        for &end in cell.iter() {
            let far = distance(at, end.at);
            if best.is_none_or(|(nearest, _)| far < nearest) {
                *best = Some((far, end));
            }
        }
    }
}

fn distance([x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) -> f64 {
    (x2 - x1).hypot(y2 - y1)
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
        for stroke in sorted(strokes) {
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
}
