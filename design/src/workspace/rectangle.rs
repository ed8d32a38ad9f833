//! The largest rectangle along the axes in which the tool may be anywhere.
//!
//! The largest one of clear cells is found exactly, in time proportional to the cells:
//! row by row, the columns of free cells that end there are a histogram, whose largest
//! rectangle is found with a stack of columns that still grow. Its sides are then moved, in
//! eighths of a cell, to where the region ends between the cells.

use super::WorkspaceMap;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::Side;
use nalgebra::Vector2;

/// Sides are placed, and looked along, in steps of this share of a cell.
const STEP: f64 = 0.125;

/// A rectangle along the axes.
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

    /// A side as the ends of a line [m]: left, right, bottom, top.
    fn side(&self, side: usize) -> [Vector2<f64>; 2] {
        let Self { low, high } = *self;
        match side {
            0 => [low, Vector2::new(low.x, high.y)],
            1 => [Vector2::new(high.x, low.y), high],
            2 => [low, Vector2::new(high.x, low.y)],
            _ => [Vector2::new(low.x, high.y), high],
        }
    }

    /// The same with a side moved outwards by `step` [m].
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
    /// The largest rectangle on an assembly branch in which every place is clear: within
    /// the joint limits, and the margin away from every singularity.
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

    /// Sides that leave the region drawn in, sides that do not pushed out; none if nothing
    /// is left.
    fn fitted(&self, mut rectangle: Rectangle, assembly: Side) -> Option<Rectangle> {
        let step = STEP * self.grid().pitch();
        let free = |rectangle: &Rectangle, side| self.is_free(rectangle.side(side), assembly);
        while let Some(side) = (0..4).find(|&side| !free(&rectangle, side)) {
            rectangle = rectangle.moved(side, -step);
            if !rectangle.has_extent() {
                return None;
            }
        }
        // The two sides that become longer do so by a step, with the new corner at its end.
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

    /// Whether every place along a line is clear on an assembly branch.
    fn is_free(&self, [from, to]: [Vector2<f64>; 2], assembly: Side) -> bool {
        let way = to - from;
        let steps = (way.length() / (STEP * self.grid().pitch()))
            .ceil()
            .max(1.0);
        (0..=steps as usize).all(|step| {
            let place = from + way * (step as f64 / steps);
            let pose = self.workspace().check(place);
            pose.is_ok_and(|pose| pose.assembly() == assembly)
        })
    }
}

/// Cells from the first up to, but without, the last column and row.
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

/// The largest rectangle of `free` cells, of which `columns` make a row.
fn largest(free: &[bool], columns: usize) -> Option<Cells> {
    let mut heights = vec![0; columns];
    let mut best: Option<Cells> = None;
    for (row, cells) in free.chunks_exact(columns).enumerate() {
        for (height, &free) in heights.iter_mut().zip(cells) {
            *height = if free { *height + 1 } else { 0 };
        }
        // Where a column begins, and how tall it can be: each taller than the one before.
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

    /// Every rectangle of every grid, cell by cell.
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
        fn none_is_larger_and_all_its_cells_are_free(
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
