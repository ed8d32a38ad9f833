//! A working mode, place by place.

use super::Grid;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Side, Workspace};
use nalgebra::Vector2;

/// A place that the tool can reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The forward branch that its pose is on.
    pub assembly: Side,
    /// Sines of the angles at the elbows of leg 1 (as the tool sees it) and of leg 4: zero
    /// at type 1.
    pub elbow_sines: [f64; 2],
    /// sin(θ3−θ2): zero at type 2.
    pub sin32: f64,
    /// 1/κ = σmin/σmax of the tool's Jacobian, 0…1.
    pub inverse_condition: f64,
    /// Whether both driven joints are within their limits.
    pub within_limits: bool,
    /// Whether they are, and the margin from singularities is kept too.
    pub clear: bool,
}

impl Cell {
    /// What is at `t` [m], if it can be reached.
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
        // At type 2 itself no bound is left to a direction's speed: κ is infinite.
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

/// Areas of a branch [m²], counted in cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Areas {
    /// All that is reached.
    pub reached: f64,
    /// What the joint limits leave of it.
    pub within_limits: f64,
    /// What the margin from singularities leaves of that.
    pub clear: f64,
}

/// A working mode on a grid.
#[derive(Clone, Debug)]
pub struct WorkspaceMap {
    workspace: Workspace<f64>,
    grid: Grid,
    cells: Vec<Option<Cell>>,
}

impl WorkspaceMap {
    /// Looks at the middle of every cell.
    pub fn new(workspace: Workspace<f64>, grid: Grid) -> Self {
        let cells =
            (0..grid.cell_count()).map(|index| Cell::at(&workspace, grid.cell_centre(index)));
        Self {
            workspace,
            grid,
            cells: cells.collect(),
        }
    }

    /// What was mapped.
    pub fn workspace(&self) -> &Workspace<f64> {
        &self.workspace
    }

    /// Where the cells are.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The cells in the grid's order; none out of reach.
    pub fn cells(&self) -> &[Option<Cell>] {
        &self.cells
    }

    /// The places that are reached [m], with what is there.
    pub fn reached(&self) -> impl Iterator<Item = (Vector2<f64>, &Cell)> {
        let cells = self.cells.iter().enumerate();
        cells.filter_map(|(index, cell)| Some((self.grid.cell_centre(index), cell.as_ref()?)))
    }

    /// The areas on an assembly branch.
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

    /// The clear place on an assembly branch where the tool moves most alike in all
    /// directions [m].
    pub fn best_conditioned(&self, assembly: Side) -> Option<(Vector2<f64>, &Cell)> {
        self.reached()
            .filter(|(_, cell)| cell.clear && cell.assembly == assembly)
            .max_by(|(_, a), (_, b)| a.inverse_condition.total_cmp(&b.inverse_condition))
    }
}
