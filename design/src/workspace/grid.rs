//! A grid of square cells over the reach of an arm.

use core::fmt;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::Tool;
use nalgebra::Vector2;

/// The greatest number of cells; a finer grid would need too much memory.
const MAX_CELLS: f64 = 2e6;

/// Square cells, row by row from the lower left. The centre of a cell represents the cell.
///
/// ```
/// use fivebar_design::workspace::{Grid, GridError};
/// use fivebar_kinematics::five_bar::{Geometry, Tool};
/// use nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let tool = Tool::new(geometry, Vector2::zeros())?;
/// let grid = Grid::over(&tool, 5e-3)?; // 5 mm
/// assert_eq!(grid.cell_count(), grid.columns() * grid.rows());
/// assert!((grid.cell_centre(0) - grid.low()).norm() < 5e-3);
/// assert_eq!(Grid::over(&tool, 0.0), Err(GridError::Pitch));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    low: Vector2<f64>,
    pitch: f64,
    columns: usize,
    rows: usize,
}

/// Why a grid is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GridError {
    /// The pitch is not a positive finite number.
    Pitch,
    /// There would be more than two million cells.
    TooFine,
}

impl fmt::Display for GridError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Pitch => "the pitch must be a positive finite number of metres",
            Self::TooFine => "there would be more than two million cells",
        })
    }
}

impl core::error::Error for GridError {}

impl Grid {
    /// A grid of this pitch [m] over the reach of the tool, symmetric about the base line as
    /// the reach is.
    ///
    /// # Errors
    /// `Pitch` for a pitch that is not positive and finite, `TooFine` for one that gives too
    /// many cells.
    pub fn over(tool: &Tool<f64>, pitch: f64) -> Result<Self, GridError> {
        if !(pitch > 0.0 && pitch.is_finite()) {
            return Err(GridError::Pitch);
        }
        let [low, high] = reach_bounds(tool);
        let cells = |size: f64| (size / pitch).ceil().max(1.0);
        let (columns, rows) = (cells(high.x - low.x), cells(high.y - low.y));
        if columns * rows > MAX_CELLS {
            return Err(GridError::TooFine);
        }
        let half = Vector2::new(columns, rows) * (0.5 * pitch);
        Ok(Self {
            low: (low + high) * 0.5 - half,
            pitch,
            columns: columns as usize,
            rows: rows as usize,
        })
    }

    /// A grid with at least `cells` cells along the longer side of the reach, with a pitch of 1, 2
    /// or 5 times a power of ten [m].
    ///
    /// # Errors
    /// As [`Grid::over`].
    pub fn with_cells(tool: &Tool<f64>, cells: u32) -> Result<Self, GridError> {
        let [low, high] = reach_bounds(tool);
        let size = (high.x - low.x).max(high.y - low.y);
        Self::over(tool, round_down(size / f64::from(cells)))
    }

    /// The lower left corner [m].
    pub fn low(&self) -> Vector2<f64> {
        self.low
    }

    /// The upper right corner [m].
    pub fn high(&self) -> Vector2<f64> {
        self.low + Vector2::new(self.columns as f64, self.rows as f64) * self.pitch
    }

    /// The side of a cell [m].
    pub fn pitch(&self) -> f64 {
        self.pitch
    }

    /// The number of cells in a row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The number of cells.
    pub fn cell_count(&self) -> usize {
        self.columns * self.rows
    }

    /// The centre of the cell with this index [m].
    pub fn cell_centre(&self, index: usize) -> Vector2<f64> {
        let (row, column) = (index / self.columns, index % self.columns);
        self.low + Vector2::new(column as f64 + 0.5, row as f64 + 0.5) * self.pitch
    }
}

/// The greatest number of 1, 2, 5, 10, 20, … that is at most `value`.
pub fn round_down(value: f64) -> f64 {
    let decade = 10_f64.powf(value.log10().floor());
    let steps = [5.0, 2.0].into_iter().find(|step| step * decade <= value);
    steps.unwrap_or(1.0) * decade
}

/// The lower left and upper right corner of a box around the reach [m]. The tool T is within
/// R1 = l1 + |BT| of A and within R4 = l4 + l3 + |CT| of E.
///
/// The two circles meet at x = (l5² + R1² − R4²)/(2 l5). If this x is between the pivots, it is
/// the highest point of both discs' intersection; else the top of one circle is within the
/// other.
pub fn reach_bounds(tool: &Tool<f64>) -> [Vector2<f64>; 2] {
    let geometry = tool.geometry();
    let far1 = geometry.l1() + tool.reach();
    let [_, far4] = geometry.leg4_radii();
    let far4 = far4 + tool.offset().length();
    let base = geometry.base();
    let meet = (base * base + far1 * far1 - far4 * far4) / (2.0 * base);
    let height = if (0.0..=base).contains(&meet) {
        (far1 * far1 - meet * meet).max(0.0).sqrt()
    } else {
        far1.min(far4)
    };
    [
        Vector2::new((-far1).max(base - far4), -height),
        Vector2::new(far1.min(base + far4), height),
    ]
}
