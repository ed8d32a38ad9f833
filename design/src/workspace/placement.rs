//! Placements at which a shape is clear as a whole.

use super::WorkspaceMap;
use fivebar_kinematics::five_bar::Side;

/// A placement of a shape on a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The column and the row that are added to the shape's.
    pub cell: [i32; 2],
    /// The least 1/κ in the shape's cells.
    pub inverse_condition: f64,
}

impl WorkspaceMap {
    /// All placements at which every cell of a shape is clear in this assembly mode. `shape` has the
    /// columns and rows of its cells, from 0.
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
    /// // A line of 40 cells to the right, 160 mm.
    /// let line: Vec<[i32; 2]> = (0..40).map(|column| [column, 0]).collect();
    /// let placements = map.placements(Side::Left, &line);
    /// assert!(!placements.is_empty());
    /// // A longer shape has fewer placements.
    /// let longer: Vec<[i32; 2]> = (0..50).map(|column| [column, 0]).collect();
    /// assert!(map.placements(Side::Left, &longer).len() < placements.len());
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    pub fn placements(&self, assembly: Side, shape: &[[i32; 2]]) -> Vec<Placement> {
        let columns = self.grid().columns() as i32;
        let rows = self.grid().rows() as i32;
        let greatest = |axis: usize| shape.iter().map(|cell| cell[axis]).max();
        let (Some(width), Some(height)) = (greatest(0), greatest(1)) else {
            return Vec::new();
        };
        let clear: Vec<f64> = self
            .cells()
            .iter()
            .map(|cell| match cell {
                Some(cell) if cell.clear && cell.assembly == assembly => cell.inverse_condition,
                _ => 0.0,
            })
            .collect();
        let indices: Vec<usize> = shape
            .iter()
            .map(|&[column, row]| (row * columns + column) as usize)
            .collect();
        let mut placements = Vec::new();
        for row in 0..rows - height {
            for column in 0..columns - width {
                let from = (row * columns + column) as usize;
                let least = least_clear(&clear[from..], &indices);
                if least > 0.0 {
                    placements.push(Placement {
                        cell: [column, row],
                        inverse_condition: least,
                    });
                }
            }
        }
        placements
    }
}

/// The least value at these indices; 0 as soon as one is 0.
fn least_clear(clear: &[f64], indices: &[usize]) -> f64 {
    let mut least = f64::MAX;
    for &index in indices {
        let value = clear[index];
        if value == 0.0 {
            return 0.0;
        }
        least = least.min(value);
    }
    least
}
