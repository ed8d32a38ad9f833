//! Outlines: the lines along which a picture is as dark as the level, by marching squares.
//!
//! Between the middles of two neighbouring pixels, of which one is darker than the level, lies a point of a line; darkness between
//! them is linear. Each square of four middles connects its two or four points, with what is dark on the left. So each point has
//! one point behind it, and the lines close.

use super::Stroke;
use super::raster::Raster;
use super::simplify::{simplified, smoothed};
use crate::budget::{Budget, OverBudget};

/// Areas smaller than this are dust [pixels²].
const DUST: f64 = 3.0;
/// Greatest distance of what is drawn from the smoothed line [pixels].
const TOLERANCE: f64 = 0.15;
/// No point follows.
const NONE: u32 = u32::MAX;

/// The outlines of what is darker than the level, closed.
pub(super) fn outlines(raster: &Raster, level: f32) -> Result<Vec<Stroke>, OverBudget> {
    let grid = Grid::new(raster, level);
    let mut next = grid.connected();
    let mut budget = Budget::points();
    let mut strokes = Vec::new();
    for first in 0..next.len() {
        let mut line = Vec::new();
        let mut at = first;
        while next[at] != NONE {
            line.push(grid.point(at));
            at = std::mem::replace(&mut next[at], NONE) as usize;
        }
        if area(&line).abs() < DUST {
            continue;
        }
        let mut line = smoothed(&line, true);
        line.extend(line.first().copied());
        let line = simplified(&line, TOLERANCE);
        budget.take(line.len())?;
        strokes.push(line);
    }
    Ok(strokes)
}

/// The area within a closed line, positive if it turns as the axes do.
fn area(line: &Stroke) -> f64 {
    let pairs = line.iter().zip(line.iter().cycle().skip(1));
    pairs.map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
}

/// The middles of pixels with a white frame around them, and the connections between neighbours: number 2 n leads from middle n to
/// the right, 2 n + 1 downwards.
struct Grid<'a> {
    raster: &'a Raster,
    level: f32,
    columns: usize,
    rows: usize,
}

impl<'a> Grid<'a> {
    fn new(raster: &'a Raster, level: f32) -> Self {
        Self {
            raster,
            level,
            columns: raster.width() + 2,
            rows: raster.height() + 2,
        }
    }

    fn dark(&self, column: usize, row: usize) -> f32 {
        self.raster.at(column as i64 - 1, row as i64 - 1)
    }

    /// Where the picture is as dark as the level on a connection.
    fn point(&self, connection: usize) -> [f64; 2] {
        let (middle, is_down) = (connection / 2, connection % 2);
        let [column, row] = [middle % self.columns, middle / self.columns];
        let from = self.dark(column, row);
        let to = self.dark(column + 1 - is_down, row + is_down);
        let share = f64::from((self.level - from) / (to - from));
        // The white frame is one pixel wide, and a middle is half a pixel from its corner.
        let [x, y] = [column as f64 - 0.5, row as f64 - 0.5];
        match is_down {
            0 => [x + share, y],
            _ => [x, y + share],
        }
    }

    /// For each connection the one whose point comes next.
    fn connected(&self) -> Vec<u32> {
        let mut next = vec![NONE; 2 * self.columns * self.rows];
        for row in 0..self.rows - 1 {
            for column in 0..self.columns - 1 {
                // Clockwise from the upper left.
                let dark =
                    [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[x, y]| self.dark(column + x, row + y));
                let is_ink = dark.map(|it| it > self.level);
                let middle = row * self.columns + column;
                // The sides after each corner: above, right, below, left.
                let sides = [
                    2 * middle,
                    2 * (middle + 1) + 1,
                    2 * (middle + self.columns),
                    2 * middle + 1,
                ];
                // A line leaves by the side on which ink ends, clockwise, and comes in by one on which it begins.
                let leaves = |side: usize| is_ink[side] && !is_ink[(side + 1) % 4];
                let comes = |side: usize| !is_ink[side] && is_ink[(side + 1) % 4];
                let meets = dark.iter().sum::<f32>() / 4.0 > self.level;
                for from in (0..4).filter(|&side| comes(side)) {
                    // Where ink meets across the middle, the line goes round the white corner before; else round the ink.
                    let turns = if meets { [3, 2, 1] } else { [1, 2, 3] };
                    let to = turns
                        .iter()
                        .map(|turn| (from + turn) % 4)
                        .find(|&side| leaves(side));
                    if let Some(to) = to {
                        next[sides[from]] = sides[to] as u32;
                    }
                }
            }
        }
        next
    }
}
