//! Paths in the plane of the two driven angles, around what is forbidden there.
//!
//! A working mode is left through a stretched or folded leg, where the inverse solution fails and
//! the forward solution does not. Such paths are therefore planned over θ1 and θ4.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Distance of the grid's nodes [rad].
const PITCH: f64 = 0.05;
/// Most searches, each without the passages that were found closed.
const SEARCHES: usize = 20;

/// The corners of a path from `from` to `to` [rad], without `from`: a straight line, or else a short path
/// over a grid within `ranges`, with its corners cut. `is_free` decides whether the arm may be at these
/// angles, `is_clear` whether it may move straight from one pair of angles to another. None: no path was
/// found.
///
/// ```
/// use fivebar_design::joint_path::find_path;
///
/// // Around a wall at 1 rad that is open above 2 rad.
/// let wall = |[a, b]: [f64; 2]| (a - 1.0).abs() < 0.1 && b < 2.0;
/// let clear = |from: [f64; 2], to: [f64; 2]| (0..=100).all(|k| {
///     let t = f64::from(k) / 100.0;
///     !wall([0, 1].map(|i| from[i] + t * (to[i] - from[i])))
/// });
/// let corners = find_path([[0.0, 3.0]; 2], [0.5, 0.5], [1.5, 0.5], |at| !wall(at), clear).unwrap();
/// assert!(corners.len() > 1 && corners.iter().any(|corner| corner[1] >= 2.0));
/// assert_eq!(corners.last(), Some(&[1.5, 0.5]));
/// ```
pub fn find_path(
    ranges: [[f64; 2]; 2],
    from: [f64; 2],
    to: [f64; 2],
    is_free: impl Fn([f64; 2]) -> bool,
    is_clear: impl Fn([f64; 2], [f64; 2]) -> bool,
) -> Option<Vec<[f64; 2]>> {
    if is_clear(from, to) {
        return Some(vec![to]);
    }
    let mut grid = Grid::new(ranges, is_free);
    let start = grid.nearest(from, |node| is_clear(from, node))?;
    let end = grid.nearest(to, |node| is_clear(node, to))?;
    for _ in 0..SEARCHES {
        let nodes = grid.shortest(start, end)?;
        let is_open = |a: usize, b: usize| is_clear(grid.point(a), grid.point(b));
        let closed = nodes.windows(2).filter(|pair| !is_open(pair[0], pair[1]));
        let closed: Vec<_> = closed.map(|pair| (pair[0], pair[1])).collect();
        if closed.is_empty() {
            let mut points = vec![from];
            points.extend(nodes.iter().map(|&node| grid.point(node)));
            points.push(to);
            return Some(with_cut_corners(&points, is_clear));
        }
        for (a, b) in closed {
            grid.close(a, b);
        }
    }
    None
}

/// The points that remain if each is left on a straight line to the farthest one that is clear from it.
fn with_cut_corners(
    points: &[[f64; 2]],
    is_clear: impl Fn([f64; 2], [f64; 2]) -> bool,
) -> Vec<[f64; 2]> {
    let (mut at, last) = (0, points.len() - 1);
    let mut corners = Vec::new();
    while at < last {
        let seen = (at + 2..=last).rev();
        let mut seen = seen.filter(|&next| is_clear(points[at], points[next]));
        at = seen.next().unwrap_or(at + 1);
        corners.push(points[at]);
    }
    corners
}

/// Even points in the ranges, and which of them are free.
struct Grid {
    low: [f64; 2],
    pitch: [f64; 2],
    count: [usize; 2],
    free: Vec<bool>,
    closed: Vec<(usize, usize)>,
}

/// A node on the border of the search, nearest first.
#[derive(PartialEq)]
struct Border {
    /// The length of the path to it and of the straight line on to the end.
    length: f64,
    node: usize,
}

impl Eq for Border {}

impl Ord for Border {
    fn cmp(&self, other: &Self) -> Ordering {
        other.length.total_cmp(&self.length)
    }
}

impl PartialOrd for Border {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Grid {
    fn new(ranges: [[f64; 2]; 2], is_free: impl Fn([f64; 2]) -> bool) -> Self {
        let count = ranges.map(|[low, high]| 2 + ((high - low) / PITCH) as usize);
        let pitch = [0, 1].map(|i| (ranges[i][1] - ranges[i][0]) / (count[i] - 1) as f64);
        let mut grid = Self {
            low: ranges.map(|[low, _]| low),
            pitch,
            count,
            free: Vec::new(),
            closed: Vec::new(),
        };
        let nodes = 0..count[0] * count[1];
        grid.free = nodes.map(|node| is_free(grid.point(node))).collect();
        grid
    }

    fn cell(&self, node: usize) -> [usize; 2] {
        [node % self.count[0], node / self.count[0]]
    }

    fn point(&self, node: usize) -> [f64; 2] {
        let cell = self.cell(node);
        [0, 1].map(|i| self.low[i] + self.pitch[i] * cell[i] as f64)
    }

    fn distance(&self, a: usize, b: usize) -> f64 {
        let ([x1, y1], [x2, y2]) = (self.point(a), self.point(b));
        (x2 - x1).hypot(y2 - y1)
    }

    /// The nearest free node within three pitches of a point that is `seen` from there.
    fn nearest(&self, point: [f64; 2], seen: impl Fn([f64; 2]) -> bool) -> Option<usize> {
        let away = |node: usize| {
            let [x, y] = self.point(node);
            (x - point[0]).hypot(y - point[1])
        };
        let nodes = 0..self.free.len();
        let near = nodes.filter(|&node| self.free[node] && away(node) < 3.0 * PITCH);
        let mut near: Vec<usize> = near.collect();
        near.sort_by(|&a, &b| away(a).total_cmp(&away(b)));
        near.into_iter().find(|&node| seen(self.point(node)))
    }

    fn close(&mut self, a: usize, b: usize) {
        self.closed.push((a.min(b), a.max(b)));
    }

    fn neighbours(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        let [x, y] = self.cell(node);
        let around = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
        let rows = around(y, self.count[1]);
        rows.flat_map(move |y| around(x, self.count[0]).map(move |x| y * self.count[0] + x))
            .filter(move |&other| {
                let passage = (node.min(other), node.max(other));
                other != node && self.free[other] && !self.closed.contains(&passage)
            })
    }

    /// The nodes of the shortest path, with both ends (A*).
    fn shortest(&self, from: usize, to: usize) -> Option<Vec<usize>> {
        let mut lengths = vec![f64::INFINITY; self.free.len()];
        let mut before = vec![from; self.free.len()];
        lengths[from] = 0.0;
        let mut border = BinaryHeap::from([Border {
            length: self.distance(from, to),
            node: from,
        }]);
        while let Some(Border { node, .. }) = border.pop() {
            if node == to {
                let mut path = vec![to];
                while path[path.len() - 1] != from {
                    path.push(before[path[path.len() - 1]]);
                }
                path.reverse();
                return Some(path);
            }
            for next in self.neighbours(node) {
                let length = lengths[node] + self.distance(node, next);
                if length < lengths[next] {
                    lengths[next] = length;
                    before[next] = node;
                    border.push(Border {
                        length: length + self.distance(next, to),
                        node: next,
                    });
                }
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::find_path;

    fn clear(wall: impl Fn([f64; 2]) -> bool) -> impl Fn([f64; 2], [f64; 2]) -> bool {
        move |from, to| {
            (0..=400).all(|k| {
                let t = f64::from(k) / 400.0;
                !wall([0, 1].map(|i| from[i] + t * (to[i] - from[i])))
            })
        }
    }

    #[test]
    fn a_closed_wall_has_no_path_and_a_hole_smaller_than_the_grid_is_not_trusted() {
        let closed = |[a, _]: [f64; 2]| (a - 1.0).abs() < 0.1;
        let ends = ([0.5, 0.5], [1.5, 0.5]);
        let found = find_path(
            [[0.0, 3.0]; 2],
            ends.0,
            ends.1,
            |at| !closed(at),
            clear(closed),
        );
        assert_eq!(found, None);
        // Every node is free, but no passage through the wall is clear.
        let thin = |[a, _]: [f64; 2]| (a - 1.01).abs() < 0.01;
        let found = find_path([[0.0, 3.0]; 2], ends.0, ends.1, |_| true, clear(thin));
        assert_eq!(found, None);
    }

    #[test]
    fn the_path_around_a_wall_is_short() {
        let wall = |[a, b]: [f64; 2]| (a - 1.0).abs() < 0.1 && b < 2.0;
        let (from, to) = ([0.5, 1.5], [1.5, 1.5]);
        let corners = find_path([[0.0, 3.0]; 2], from, to, |at| !wall(at), clear(wall)).unwrap();
        let mut length = 0.0;
        let mut at = from;
        for corner in corners {
            assert!(clear(wall)(at, corner));
            length += (corner[0] - at[0]).hypot(corner[1] - at[1]);
            at = corner;
        }
        // Around both corners of the wall: 2 √(0.4² + 0.5²) + 0.2.
        assert!((1.4806..1.60).contains(&length), "{length}");
    }
}
