//! The largest rectangle parallel to the axes in which every position is clear.
//!
//! The largest rectangle of clear cells is exact, found in time proportional to the number of
//! cells: in each row, the columns of clear cells that end there form a histogram, and a
//! stack of increasing columns gives its largest rectangle. Then the sides are moved, in
//! eighths of a cell, to the edge of the clear region between the cells.

use super::WorkspaceMap;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::Side;
use nalgebra::Vector2;

/// The step in which sides are moved and checked, as a share of a cell.
const STEP: f64 = 0.125;

/// A rectangle parallel to the axes.
///
/// ```
/// use fivebar_design::workspace::{Grid, WorkspaceMap};
/// use fivebar_kinematics::five_bar::{Geometry, Side, Tool, WorkingMode, Workspace};
/// use nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let (tool, mode) = (Tool::new(geometry, Vector2::zeros())?, WorkingMode::new(Side::Right, Side::Left));
/// let workspace = Workspace { tool, mode, limits: None, margin: 0.15 };
/// let map = WorkspaceMap::new(workspace, Grid::over(&tool, 4e-3)?);
/// let rectangle = map.largest_rectangle(Side::Left).ok_or("no clear rectangle")?;
/// // It is clear everywhere, and smaller than all that is clear.
/// assert!(workspace.check((rectangle.low + rectangle.high) * 0.5).is_ok());
/// assert!(rectangle.area() < map.areas(Side::Left).clear);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Lower left corner [m].
    pub low: Vector2<f64>,
    /// Upper right corner [m].
    pub high: Vector2<f64>,
}

impl Rectangle {
    /// Its width and height [m].
    pub fn size(&self) -> Vector2<f64> {
        self.high - self.low
    }

    /// Its area [m²].
    pub fn area(&self) -> f64 {
        self.size().x * self.size().y
    }

    fn has_extent(&self) -> bool {
        self.size().x > 0.0 && self.size().y > 0.0
    }

    /// The end points of a side [m]; 0 left, 1 right, 2 bottom, 3 top.
    fn side(&self, side: usize) -> [Vector2<f64>; 2] {
        let Self { low, high } = *self;
        match side {
            0 => [low, Vector2::new(low.x, high.y)],
            1 => [Vector2::new(high.x, low.y), high],
            2 => [low, Vector2::new(high.x, low.y)],
            _ => [Vector2::new(low.x, high.y), high],
        }
    }

    /// The same rectangle with one side moved outwards by `step` [m].
    fn moved(mut self, side: usize, step: f64) -> Self {
        match side {
            0 => self.low.x -= step,
            1 => self.high.x += step,
            2 => self.low.y -= step,
            _ => self.high.y += step,
        }
        self
    }
}

impl WorkspaceMap {
    /// The largest rectangle of an assembly mode in which every position is clear: within
    /// the joint limits and outside the singularity margin. None if there is none.
    pub fn largest_rectangle(&self, assembly: Side) -> Option<Rectangle> {
        let free: Vec<bool> = self
            .cells()
            .iter()
            .map(|cell| cell.is_some_and(|cell| cell.clear && cell.assembly == assembly))
            .collect();
        let columns = self.grid().columns();
        let Cells {
            columns: [left, right],
            rows: [low, high],
        } = largest(&free, columns)?;
        self.fitted(
            Rectangle {
                low: self.grid().cell_centre(low * columns + left),
                high: self.grid().cell_centre((high - 1) * columns + right - 1),
            },
            assembly,
        )
    }

    /// Moves sides that leave the clear region inwards, then all sides outwards as far as
    /// they stay clear; none if no rectangle is left.
    fn fitted(&self, mut rectangle: Rectangle, assembly: Side) -> Option<Rectangle> {
        let step = STEP * self.grid().pitch();
        let free = |rectangle: &Rectangle, side| self.is_free(rectangle.side(side), assembly);
        while let Some(side) = (0..4).find(|&side| !free(&rectangle, side)) {
            rectangle = rectangle.moved(side, -step);
            if !rectangle.has_extent() {
                return None;
            }
        }
        // The two adjacent sides become longer by this step. Its end is a corner, which is
        // checked with the moved side.
        for side in 0..4 {
            loop {
                let larger = rectangle.moved(side, step);
                if !free(&larger, side) {
                    break;
                }
                rectangle = larger;
            }
        }
        rectangle.has_extent().then_some(rectangle)
    }

    /// Whether every position along a line is clear in an assembly mode.
    fn is_free(&self, [from, to]: [Vector2<f64>; 2], assembly: Side) -> bool {
        let line = to - from;
        let steps = (line.length() / (STEP * self.grid().pitch()))
            .ceil()
            .max(1.0);
        (0..=steps as usize).all(|step| {
            let point = from + line * (step as f64 / steps);
            let pose = self.workspace().check(point);
            pose.is_ok_and(|pose| pose.assembly() == assembly)
        })
    }
}

/// A block of cells as half-open ranges of columns and rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Cells {
    columns: [usize; 2],
    rows: [usize; 2],
}

impl Cells {
    fn count(&self) -> usize {
        (self.columns[1] - self.columns[0]) * (self.rows[1] - self.rows[0])
    }
}

/// The largest rectangle of `free` cells; a row has `columns` cells.
fn largest(free: &[bool], columns: usize) -> Option<Cells> {
    let mut heights = vec![0; columns];
    let mut best: Option<Cells> = None;
    for (row, cells) in free.chunks_exact(columns).enumerate() {
        for (height, &free) in heights.iter_mut().zip(cells) {
            *height = if free { *height + 1 } else { 0 };
        }
        // First column and height of each open rectangle, in order of increasing height.
        let mut growing: Vec<(usize, usize)> = Vec::new();
        for (column, height) in heights.iter().copied().chain([0]).enumerate() {
            let mut start = column;
            while let Some((begin, tall)) = growing.pop_if(|&mut (_, tall)| tall > height) {
                let found = Cells {
                    columns: [begin, column],
                    rows: [row + 1 - tall, row + 1],
                };
                if best.is_none_or(|best| found.count() > best.count()) {
                    best = Some(found);
                }
                start = begin;
            }
            growing.push((start, height));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::{Cells, largest};
    use proptest::prelude::*;

    /// The size of the largest rectangle, found by trying every rectangle.
    fn by_trying(free: &[bool], columns: usize) -> usize {
        let rows = free.len() / columns;
        let mut best = 0;
        for (left, low) in (0..columns).flat_map(|c| (0..rows).map(move |r| (c, r))) {
            for (right, high) in
                (left + 1..=columns).flat_map(|c| (low + 1..=rows).map(move |r| (c, r)))
            {
                let all = (low..high).all(|r| (left..right).all(|c| free[r * columns + c]));
                if all {
                    best = best.max((right - left) * (high - low));
                }
            }
        }
        best
    }

    proptest! {
        #[test]
        fn largest_rectangle_is_free_and_as_large_as_the_one_found_by_trying_all(
            columns in 1_usize..7,
            cells in prop::collection::vec(prop::bool::weighted(0.75), 1..42),
        ) {
            let free = &cells[..cells.len() / columns * columns];
            let found = largest(free, columns);
            prop_assert_eq!(found.map_or(0, |f| f.count()), by_trying(free, columns));
            if let Some(Cells { columns: [left, right], rows: [low, high] }) = found {
                for row in low..high {
                    prop_assert!((left..right).all(|column| free[row * columns + column]));
                }
            }
        }
    }
}
