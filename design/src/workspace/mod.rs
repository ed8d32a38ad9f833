//! The workspace of an arm: the [`WorkspaceMap`] of one working mode, its
//! [`singularity_curves`], and the largest clear [`Rectangle`].
//!
//! A *branch* is a working mode together with an assembly mode. In one working mode a
//! position has at most one pose, so the two assembly modes divide the reach between them;
//! the boundary is the type 2 singularity. All four working modes have the same reach if the
//! tool is at C.
//!
//! ```
//! use nalgebra::Vector2;
//! use fivebar_kinematics::five_bar::{Geometry, Side, Tool, WorkingMode, Workspace};
//! use fivebar_design::workspace::{Grid, WorkspaceMap, reachable_area, singularity_curves};
//!
//! let arm = Geometry::new([0.10, 0.16, 0.16, 0.10, 0.08])?;
//! let workspace = Workspace {
//!     tool: Tool::new(arm, Vector2::zeros())?,
//!     mode: WorkingMode::new(Side::Right, Side::Left),
//!     limits: None,
//!     margin: 0.15,
//! };
//! let map = WorkspaceMap::new(workspace, Grid::over(&workspace.tool, 2e-3)?);
//! let reached: f64 = Side::BOTH.map(|side| map.areas(side).reached).iter().sum();
//! assert!((reached / reachable_area(&arm) - 1.0).abs() < 1e-2);
//! // Row by row from the lower left; `None` for a cell out of reach.
//! assert_eq!(map.cells().len(), map.grid().cell_count());
//! for curve in singularity_curves(&workspace.tool, workspace.mode) {
//!     assert!(curve.points.len() > 1);
//! }
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```

mod grid;
mod map;
mod placement;
mod reach;
mod rectangle;
mod singularity_curves;

pub use grid::{Grid, GridError, reach_bounds, round_down};
pub use map::{Areas, Cell, WorkspaceMap};
pub use placement::Placement;
pub use reach::{Arc, reach_boundary, reachable_area};
pub use rectangle::Rectangle;
pub use singularity_curves::{SingularityCurve, singularity_curves};
