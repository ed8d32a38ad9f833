//! Random arms, their maps, and the assembly mode at a position.

use fivebar_design::workspace::{Grid, SingularityCurve};
use fivebar_kinematics::five_bar::{Side, Tool, WorkingMode, Workspace};
use fivebar_testkit::geometry;
use nalgebra::Vector2;
use proptest::prelude::*;

/// Any arm, its tool at C or a few centimetres beside it.
pub(crate) fn tool() -> impl Strategy<Value = Tool<f64>> {
    let offset = prop_oneof![
        Just(Vector2::zeros()),
        (-0.04..0.04_f64, -0.04..0.04_f64).prop_map(|(along, left)| Vector2::new(along, left)),
    ];
    (geometry(), offset).prop_filter_map("tool on B", |(geometry, offset)| {
        Tool::new(geometry, offset).ok()
    })
}

pub(crate) fn unbounded(tool: Tool<f64>, mode: WorkingMode) -> Workspace<f64> {
    Workspace {
        tool,
        mode,
        limits: None,
        margin: 0.0,
    }
}

/// A grid with about this many cells along its longer side.
pub(crate) fn grid(tool: &Tool<f64>, cells: f64) -> Grid {
    let size = tool.geometry().lengths().iter().sum::<f64>();
    Grid::over(tool, size / cells).unwrap()
}

pub(crate) fn segments(curve: &SingularityCurve) -> impl Iterator<Item = [Vector2<f64>; 2]> {
    curve.points.windows(2).map(|ends| [ends[0], ends[1]])
}

/// The assembly mode at a position, if it is reached.
pub(crate) fn assembly(workspace: &Workspace<f64>, t: Vector2<f64>) -> Option<Side> {
    let pose = workspace.tool.inverse(t, workspace.mode).ok()?;
    Some(pose.assembly())
}
