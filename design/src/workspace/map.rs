//! The map of a working mode, cell by cell.

use super::Grid;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Side, Workspace};
use nalgebra::Vector2;

/// The properties of a position that the tool reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The assembly mode of its pose.
    pub assembly: Side,
    /// The sines of the angles at the elbows of leg 1 (A–B–T) and of leg 4: zero at a type 1
    /// singularity.
    pub elbow_sines: [f64; 2],
    /// sin(θ3−θ2): zero at a type 2 singularity.
    pub sin32: f64,
    /// 1/κ = σmin/σmax of the tool's Jacobian, 0…1.
    pub inverse_condition: f64,
    /// Whether both driven joints are within their limits.
    pub within_limits: bool,
    /// Whether the position is clear: within the joint limits and outside the singularity
    /// margin.
    pub clear: bool,
}

impl Cell {
    /// The properties of the position `t` [m]; none if it is out of reach.
    fn at(workspace: &Workspace<f64>, t: Vector2<f64>) -> Option<Self> {
        let Workspace {
            tool,
            mode,
            limits,
            margin,
        } = workspace;
        let pose = tool.inverse(t, *mode).ok()?;
        let within_limits = limits.is_none_or(|limits| {
            limits
                .angles_within(pose.u1.polar_angle(), pose.u4.polar_angle())
                .is_ok()
        });
        // At a type 2 singularity κ is infinite, and there is no Jacobian.
        let jacobian = tool.jacobian(&pose);
        Some(Self {
            assembly: pose.assembly(),
            elbow_sines: tool.elbow_sines(&pose),
            sin32: pose.sin32(),
            inverse_condition: jacobian.map_or(0.0, |jacobian| jacobian.inverse_condition()),
            within_limits,
            clear: within_limits && tool.nearest_singularity(&pose).1 >= *margin,
        })
    }
}

/// The areas of a branch [m²], counted in cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Areas {
    /// The reached area.
    pub reached: f64,
    /// The part of it within the joint limits.
    pub within_limits: f64,
    /// The part of that outside the singularity margin.
    pub clear: f64,
}

/// The map of one working mode on a grid.
#[derive(Clone, Debug)]
pub struct WorkspaceMap {
    workspace: Workspace<f64>,
    grid: Grid,
    cells: Vec<Option<Cell>>,
}

impl WorkspaceMap {
    /// Solves the pose at the centre of every cell.
    pub fn new(workspace: Workspace<f64>, grid: Grid) -> Self {
        let cells =
            (0..grid.cell_count()).map(|index| Cell::at(&workspace, grid.cell_centre(index)));
        Self {
            workspace,
            grid,
            cells: cells.collect(),
        }
    }

    /// The arm, working mode, joint limits and singularity margin of the map.
    pub fn workspace(&self) -> &Workspace<f64> {
        &self.workspace
    }

    /// The grid of the cells.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The cells in the order of the grid; none for a cell out of reach.
    pub fn cells(&self) -> &[Option<Cell>] {
        &self.cells
    }

    /// The reached positions [m] with their properties.
    pub fn reached(&self) -> impl Iterator<Item = (Vector2<f64>, &Cell)> {
        let cells = self.cells.iter().enumerate();
        cells.filter_map(|(index, cell)| Some((self.grid.cell_centre(index), cell.as_ref()?)))
    }

    /// The map on which a cell is clear in this assembly mode only if all cells within `margin` [m] around it are.
    #[must_use]
    pub fn with_margin(mut self, assembly: Side, margin: f64) -> Self {
        let [columns, rows] = [self.grid.columns(), self.grid.rows()].map(|it| it as i64);
        let wide = ((margin / self.grid.pitch()).floor() as i64).min(columns.max(rows));
        let offsets = (-wide..=wide).flat_map(|x| (-wide..=wide).map(move |y| [x, y]));
        let disc: Vec<[i64; 2]> = offsets
            .filter(|[x, y]| x * x + y * y <= wide * wide)
            .collect();
        let is_clear = |[column, row]: [i64; 2]| {
            let is_inside = (0..columns).contains(&column) && (0..rows).contains(&row);
            let cell = is_inside.then(|| self.cells[(row * columns + column) as usize]);
            cell.flatten()
                .is_some_and(|cell| cell.clear && cell.assembly == assembly)
        };
        let keeps = |index: usize| {
            let [column, row] = [index as i64 % columns, index as i64 / columns];
            disc.iter().all(|[x, y]| is_clear([column + x, row + y]))
        };
        let kept: Vec<bool> = (0..self.cells.len()).map(keeps).collect();
        for (cell, kept) in self.cells.iter_mut().zip(kept) {
            if let Some(cell) = cell {
                cell.clear &= kept || cell.assembly != assembly;
            }
        }
        self
    }

    /// The areas of an assembly mode.
    pub fn areas(&self, assembly: Side) -> Areas {
        let cell_area = self.grid.pitch() * self.grid.pitch();
        let on_branch = |cell: &&Cell| cell.assembly == assembly;
        let area = |counts: fn(&Cell) -> bool| {
            let cells = self.cells.iter().flatten().filter(on_branch);
            cells.filter(|cell| counts(cell)).count() as f64 * cell_area
        };
        Areas {
            reached: area(|_| true),
            within_limits: area(|cell| cell.within_limits),
            clear: area(|cell| cell.clear),
        }
    }

    /// The clear position [m] of an assembly mode with the least condition number κ.
    pub fn best_conditioned(&self, assembly: Side) -> Option<(Vector2<f64>, &Cell)> {
        self.reached()
            .filter(|(_, cell)| cell.clear && cell.assembly == assembly)
            .max_by(|(_, a), (_, b)| a.inverse_condition.total_cmp(&b.inverse_condition))
    }
}
