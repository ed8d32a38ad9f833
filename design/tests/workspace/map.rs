//! Maps and the largest rectangles in them.

use crate::arms::{grid, tool, unbounded};
use fivebar_design::workspace::{
    Grid, GridError, Rectangle, WorkspaceMap, reach_boundary, reach_bounds, reachable_area,
};
use fivebar_kinematics::five_bar::{Geometry, JointLimits, Side, Tool, WorkingMode, Workspace};
use fivebar_testkit::{Tally, assert_close, geometry, mode};
use nalgebra::Vector2;
use proptest::prelude::*;

fn benchtop() -> Workspace<f64> {
    let geometry = Geometry::new([0.10, 0.16, 0.16, 0.10, 0.08]).unwrap();
    Workspace {
        tool: Tool::new(geometry, Vector2::zeros()).unwrap(),
        mode: WorkingMode::new(Side::Right, Side::Left),
        limits: JointLimits::new([0.6, 3.6], [-0.46, 2.54]).ok(),
        margin: 0.15,
    }
}

/// The cells of every working mode fill the exact area.
fn assert_filled(geometry: &Geometry<f64>) -> Result<(), TestCaseError> {
    let tool = Tool::new(*geometry, Vector2::zeros()).unwrap();
    let grid = grid(&tool, 300.0);
    let exact = reachable_area(geometry);
    // Whether a cell that the boundary cuts counts is random.
    let boundary: f64 = reach_boundary(geometry)
        .map(|arc| arc.radius * (arc.to - arc.from))
        .sum();
    for mode in WorkingMode::ALL {
        let map = WorkspaceMap::new(unbounded(tool, mode), grid);
        let counted: f64 = Side::BOTH.map(|side| map.areas(side).reached).iter().sum();
        let bound = (0.2 * boundary + 10.0 * grid.pitch()) * grid.pitch();
        prop_assert!(
            (counted - exact).abs() < bound,
            "{counted} for {exact} m² in {mode:?}"
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn the_cells_of_every_mode_fill_the_exact_area(geometry in geometry()) {
        assert_filled(&geometry)?;
    }
}

/// An arm for which random tests once found an error.
#[test]
fn the_cells_of_an_arm_with_a_long_base_fill_its_area() {
    let lengths = [
        0.066_133_396_538_912_66,
        0.111_467_133_097_687,
        0.109_141_579_143_612_75,
        0.200_762_718_398_447_78,
        0.485_716_851_994_911_77,
    ];
    assert_filled(&Geometry::new(lengths).unwrap()).unwrap();
}

#[test]
fn nothing_in_the_largest_rectangle_is_refused() {
    let found = Tally::default();
    let range = (-3.0..0.0_f64, 1.0..4.0_f64);
    let workspaces = (
        tool(),
        mode(),
        0.02..0.4_f64,
        prop::option::of([range.clone(), range]),
    );
    let shares = prop::collection::vec((0.0..=1.0_f64, 0.0..=1.0_f64), 500);
    proptest!(ProptestConfig::with_cases(48), |((tool, mode, margin, limits) in workspaces, shares in shares)| {
        let limits = limits.map(|[(a, b), (c, d)]| JointLimits::new([a, a + b], [c, c + d]).unwrap());
        let workspace = Workspace { tool, mode, limits, margin };
        let map = WorkspaceMap::new(workspace, grid(&tool, 150.0));
        for branch in Side::BOTH {
            let rectangle = map.largest_rectangle(branch);
            found.count(rectangle.is_some());
            let Some(rectangle) = rectangle else {
                // A coaxial arm's ring can be long and only a few cells wide.
                let cells = if tool.geometry().lengths()[4] == 0.0 { 3000.0 } else { 300.0 };
                prop_assert!(map.areas(branch).clear < cells * map.grid().pitch().powi(2));
                continue;
            };
            let size = rectangle.size();
            for &(across, up) in &shares {
                let t = rectangle.low + Vector2::new(size.x * across, size.y * up);
                let pose = workspace.check(t);
                prop_assert!(pose.is_ok_and(|pose| pose.assembly() == branch), "{t:?} in {rectangle:?}");
            }
            for larger in grown(rectangle, map.grid().pitch()) {
                prop_assert!(!is_free(&workspace, larger, branch), "{larger:?}");
            }
        }
    });
    found.assert_accepted(0.6);
}

/// A rectangle with one side moved outwards.
fn grown(rectangle: Rectangle, by: f64) -> [Rectangle; 4] {
    let Rectangle { low, high } = rectangle;
    let (x, y) = (Vector2::new(by, 0.0), Vector2::new(0.0, by));
    [
        Rectangle { low: low - x, high },
        Rectangle {
            low,
            high: high + x,
        },
        Rectangle { low: low - y, high },
        Rectangle {
            low,
            high: high + y,
        },
    ]
}

/// Whether every position of a fine grid over a rectangle is clear on a branch.
fn is_free(workspace: &Workspace<f64>, rectangle: Rectangle, branch: Side) -> bool {
    let size = rectangle.size();
    (0..=400).all(|i| {
        (0..=400).all(|j| {
            let share = [f64::from(i) / 400.0, f64::from(j) / 400.0];
            let t = rectangle.low + Vector2::new(size.x * share[0], size.y * share[1]);
            let pose = workspace.check(t);
            pose.is_ok_and(|pose| pose.assembly() == branch)
        })
    })
}

#[test]
fn limits_and_margin_take_their_share_of_the_benchtop() {
    let workspace = benchtop();
    let map = WorkspaceMap::new(workspace, grid(&workspace.tool, 600.0));
    let left = map.areas(Side::Left);
    assert!(left.clear < left.within_limits && left.within_limits < left.reached);
    assert!(left.clear > 0.0);
    let (place, best) = map.best_conditioned(Side::Left).unwrap();
    assert!(best.clear && best.inverse_condition > 0.9, "{best:?}");
    assert_close("symmetric", place.x, 0.04, 0.01);
    let others = map
        .reached()
        .filter(|(_, cell)| cell.clear && cell.assembly == Side::Left);
    for (_, cell) in others {
        assert!(cell.inverse_condition <= best.inverse_condition);
    }
}

#[test]
fn an_arm_that_reaches_one_point_has_a_map_of_one_cell_at_most() {
    // The base is as long as all the links together.
    let geometry = Geometry::new([0.1, 0.1, 0.1, 0.1, 0.4]).unwrap();
    let tool = Tool::new(geometry, Vector2::zeros()).unwrap();
    for mode in WorkingMode::ALL {
        let map = WorkspaceMap::new(unbounded(tool, mode), Grid::over(&tool, 1e-3).unwrap());
        assert!(map.reached().count() <= 1);
        for branch in Side::BOTH {
            assert_eq!(map.largest_rectangle(branch), None);
        }
    }
}

#[test]
fn a_pitch_that_makes_no_grid_is_refused() {
    let tool = benchtop().tool;
    for pitch in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        assert_eq!(Grid::over(&tool, pitch), Err(GridError::Pitch));
    }
    assert_eq!(Grid::over(&tool, 1e-6), Err(GridError::TooFine));
    // As high as where the circles of 0.2 m about pivots 0.24 m apart meet.
    let [low, high] = reach_bounds(
        &Tool::new(
            Geometry::new([0.1, 0.1, 0.1, 0.1, 0.24]).unwrap(),
            Vector2::zeros(),
        )
        .unwrap(),
    );
    assert_close("lowest", low.y, -0.16, 1e-15);
    assert_close("highest", high.y, 0.16, 1e-15);
    assert_close("rightmost", high.x, 0.2, 1e-15);
    // Mirrored about the base line, around the whole reach.
    let grid = Grid::over(&tool, 1e-3).unwrap();
    assert_close("mirrored", grid.low().y, -grid.high().y, 1e-15);
    assert!(grid.low().x <= -0.18 && grid.high().x >= 0.26);
}
