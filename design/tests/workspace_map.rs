//! Maps, singularity curves and rectangles against areas, determinants and places found
//! otherwise.

use fivebar_design::workspace::{
    Grid, GridError, Locus, Map, Rectangle, bounds, loci, reach_boundary, reachable_area,
};
use fivebar_kinematics::Vec2;
use fivebar_kinematics::five_bar::{
    Geometry, JointLimits, Pose, Side, Singularity, Tool, WorkingMode, Workspace,
};
use fivebar_testkit::{assert_close, geometry, mode};
use proptest::prelude::*;

/// Any arm, its tool at C or a few centimetres beside it.
fn tool() -> impl Strategy<Value = Tool<f64>> {
    let offset = prop_oneof![
        Just(Vec2::zero()),
        (-0.04..0.04_f64, -0.04..0.04_f64).prop_map(|(along, left)| Vec2::new(along, left)),
    ];
    (geometry(), offset).prop_filter_map("tool on B", |(geometry, offset)| {
        Tool::new(geometry, offset).ok()
    })
}

fn unbounded(tool: Tool<f64>, mode: WorkingMode) -> Workspace<f64> {
    Workspace {
        tool,
        mode,
        limits: None,
        margin: 0.0,
    }
}

fn benchtop() -> Workspace<f64> {
    let geometry = Geometry::new([0.10, 0.16, 0.16, 0.10, 0.08]).unwrap();
    Workspace {
        tool: Tool::new(geometry, Vec2::zero()).unwrap(),
        mode: WorkingMode::new(Side::Right, Side::Left),
        limits: JointLimits::new([0.6, 3.6], [-0.46, 2.54]).ok(),
        margin: 0.15,
    }
}

/// A grid of about so many cells along its longer side.
fn grid(tool: &Tool<f64>, cells: f64) -> Grid {
    let size = tool.geometry().lengths().iter().sum::<f64>();
    Grid::over(tool, size / cells).unwrap()
}

fn segments(locus: &Locus) -> impl Iterator<Item = [Vec2<f64>; 2]> {
    locus.points.windows(2).map(|ends| [ends[0], ends[1]])
}

/// The assembly branch at a place, if it is reached.
fn assembly(workspace: &Workspace<f64>, t: Vec2<f64>) -> Option<Side> {
    let pose = workspace.tool.inverse(t, workspace.mode).ok()?;
    Some(pose.assembly())
}

/// ½∮(x dy − y dx) around a branch, along those of its singularity curves that border it:
/// which side of a chord is in the branch is asked a hair's breadth beside both its ends.
fn enclosed_area(workspace: &Workspace<f64>, curves: &[Locus], branch: Side) -> f64 {
    let inside = |t| f64::from(u8::from(assembly(workspace, t) == Some(branch)));
    let chords = curves.iter().flat_map(segments).map(|[from, to]| {
        let across = (to - from).perp() * (1e-8 / (to - from).norm().max(1e-12));
        let borders = |end| inside(end + across) - inside(end - across);
        0.5 * from.cross(to) * 0.5 * (borders(from) + borders(to))
    });
    chords.sum()
}

#[test]
fn the_textbook_arm_loses_hold_where_the_literature_says() {
    let geometry = Geometry::new([0.23, 0.23, 0.23, 0.23, 0.275]).unwrap();
    let tool = Tool::new(geometry, Vec2::zero()).unwrap();
    // Elbows out, in the middle: links 2 and 3 in line, C 0.21057956 above the base.
    let curves = loci(&tool, WorkingMode::new(Side::Right, Side::Left));
    let in_line = curves
        .iter()
        .filter(|c| c.singularity == Singularity::Parallel);
    let crossings: Vec<f64> = in_line
        .flat_map(segments)
        .filter(|[from, to]| (from.x < 0.1375) != (to.x < 0.1375))
        .map(|[from, to]| from.y + (to.y - from.y) * (0.1375 - from.x) / (to.x - from.x))
        .collect();
    let nearest = |y: f64| crossings.iter().map(|c| (c - y).abs()).fold(1.0, f64::min);
    // Within the chord of 2 mm that crosses the middle: (2 mm)²/8r, r about 2 cm.
    assert!(nearest(0.210_579_56) < 3e-5, "{crossings:?}");
    // Elbows in, B = D at θ1 = 53.28564°: C is anywhere on a circle about them.
    let b = Vec2::unit(53.285_64_f64.to_radians()) * 0.23;
    let curves = loci(&tool, WorkingMode::new(Side::Left, Side::Right));
    let on_circle = curves.iter().flat_map(|curve| &curve.points);
    let on_circle = on_circle
        .filter(|&&c| ((c - b).norm() - 0.23).abs() < 1e-7)
        .count();
    assert!(on_circle > 20, "{on_circle} points");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn the_cells_of_every_mode_fill_the_exact_area(geometry in geometry()) {
        let tool = Tool::new(geometry, Vec2::zero()).unwrap();
        let grid = grid(&tool, 300.0);
        let exact = reachable_area(&geometry);
        // A cell that the boundary cuts is counted or not by chance.
        let boundary: f64 = reach_boundary(&geometry).map(|arc| arc.radius * (arc.to - arc.from)).sum();
        for mode in WorkingMode::ALL {
            let map = Map::new(unbounded(tool, mode), grid);
            let counted: f64 = Side::BOTH.map(|side| map.areas(side).reached).iter().sum();
            let bound = (0.2 * boundary + 10.0 * grid.pitch()) * grid.pitch();
            prop_assert!((counted - exact).abs() < bound, "{counted} for {exact} m² in {mode:?}");
        }
    }

    #[test]
    fn the_bounds_hold_all_that_is_reached(tool in tool(), mode in mode()) {
        let [low, high] = bounds(&tool);
        let curves = loci(&tool, mode);
        let points = || curves.iter().flat_map(|curve| &curve.points);
        for point in points() {
            prop_assert!(low.x - 1e-12 <= point.x && point.x <= high.x + 1e-12, "{point:?}");
            prop_assert!(low.y - 1e-12 <= point.y && point.y <= high.y + 1e-12, "{point:?}");
        }
    }

    #[test]
    fn singularity_curves_enclose_the_area_of_each_branch(tool in tool(), mode in mode()) {
        let workspace = unbounded(tool, mode);
        let grid = grid(&tool, 300.0);
        let map = Map::new(workspace, grid);
        let curves = loci(&tool, mode);
        let length: f64 = curves.iter().flat_map(segments).map(|[a, b]| (b - a).norm()).sum();
        for branch in Side::BOTH {
            let counted = map.areas(branch).reached;
            let enclosed = enclosed_area(&workspace, &curves, branch);
            let bound = (0.2 * length + 10.0 * grid.pitch()) * grid.pitch();
            prop_assert!((counted - enclosed).abs() < bound, "{branch:?}: {counted} for {enclosed} m²");
        }
    }

    #[test]
    fn every_curve_is_where_its_sine_vanishes(tool in tool(), mode in mode()) {
        for locus in loci(&tool, mode) {
            prop_assert!(locus.points.len() > 1);
            for point in &locus.points {
                // Beyond an edge of reach by rounding there is no pose to look at.
                let Ok(pose) = tool.inverse(*point, mode) else { continue };
                let [sine1, sine4] = tool.elbow_sines(&pose);
                let sine = match locus.singularity {
                    Singularity::Leg1 => sine1,
                    // Where a leg is singular too, a place says little of the rest.
                    Singularity::Leg4 => sine4 * sine1.abs(),
                    Singularity::Parallel => pose.sin32() * (sine1 * sine4).abs(),
                };
                prop_assert!(sine.abs() < 1e-6, "{sine} at {point:?}, {:?}", locus.singularity);
            }
        }
    }

    #[test]
    fn a_curve_lies_wherever_the_determinant_changes_sign(tool in tool(), mode in mode()) {
        let map = Map::new(unbounded(tool, mode), grid(&tool, 120.0));
        let curves = loci(&tool, mode);
        let in_line = curves.iter().filter(|c| c.singularity == Singularity::Parallel);
        let chords: Vec<_> = in_line.flat_map(segments).collect();
        let (columns, pitch) = (map.grid().columns(), map.grid().pitch());
        for (index, cell) in map.cells().iter().enumerate() {
            for next in [index + 1, index + columns] {
                let (Some(one), Some(Some(other))) = (cell, map.cells().get(next)) else { continue };
                if next % columns == 0 || one.assembly == other.assembly { continue }
                prop_assert!(one.sin32 * other.sin32 <= 0.0);
                let way = map.grid().middle(next) - map.grid().middle(index);
                let between = |step: u32| map.grid().middle(index) + way * (f64::from(step) / 64.0);
                if (0..64).any(|step| assembly(map.workspace(), between(step)).is_none()) { continue }
                let middle = (map.grid().middle(index) + map.grid().middle(next)) * 0.5;
                // A chord is within half its length of its curve, however tight that bends.
                let [nearest, half] = chords
                    .iter()
                    .map(|&[from, to]| [distance(middle, [from, to]), 0.5 * (to - from).norm()])
                    .min_by(|a, b| (a[0] - a[1]).total_cmp(&(b[0] - b[1])))
                    .unwrap_or([1.0, 0.0]);
                prop_assert!(nearest < 0.51 * pitch + half, "{nearest} m from {middle:?}");
            }
        }
        // No change, no curve: beside one of any length, the other branch is on its other side.
        let length: f64 = chords.iter().map(|[a, b]| (*b - *a).norm()).sum();
        let changes = chords.iter().filter(|[from, to]| {
            let across = (*to - *from).perp() * (1e-7 / (*to - *from).norm().max(1e-12));
            let sides = [*from + across, *from - across].map(|t| assembly(map.workspace(), t));
            matches!(sides, [Some(one), Some(other)] if one != other)
        });
        let share = changes.count() as f64 / chords.len().max(1) as f64;
        prop_assert!(share > 0.5 || length < 20.0 * pitch, "{length} m of curve, {share} of it with a change");
    }

    #[test]
    fn the_tools_jacobian_is_its_derivative(
        tool in tool(), mode in mode(), x in -0.5..0.5_f64, y in -0.5..0.5_f64
    ) {
        let Ok(pose) = tool.inverse(Vec2::new(x, y), mode) else { return Ok(()) };
        prop_assume!(tool.nearest_singularity(&pose).1 > 0.1);
        let jacobian = tool.jacobian(&pose).unwrap();
        let moved = |h: [f64; 2]| at(&tool, &pose, h);
        let h = 1e-6;
        // Of fourth order: near a singularity h² times the third derivative is too much.
        let column = |x: f64, y: f64| {
            let across = |k: f64| (moved([k * x, k * y]) - moved([-k * x, -k * y])) * (0.5 / (k * h));
            (across(1.0) * 4.0 - across(2.0)) * (1.0 / 3.0)
        };
        let columns = [column(h, 0.0), column(0.0, h)];
        let scale = jacobian.singular_values()[0].max(1.0);
        for (exact, found) in [jacobian.c1, jacobian.c4].into_iter().zip(columns) {
            prop_assert!(exact.norm() > 1e-4);
            prop_assert!((exact - found).norm() < 1e-7 * scale, "{found:?} for {exact:?}");
        }
        let matrix = nalgebra::Matrix2::new(columns[0].x, columns[1].x, columns[0].y, columns[1].y);
        let values = matrix.singular_values();
        let expected = values.min() / values.max();
        prop_assert!((jacobian.inverse_condition() - expected).abs() < 1e-6);
    }

    #[test]
    fn nothing_in_the_largest_rectangle_is_refused(
        tool in tool(), mode in mode(), margin in 0.02..0.4_f64,
        limits in prop::option::of(prop::array::uniform2((-3.0..0.0_f64, 1.0..4.0_f64))),
        shares in prop::collection::vec((0.0..=1.0_f64, 0.0..=1.0_f64), 500),
    ) {
        let limits = limits.map(|[(a, b), (c, d)]| JointLimits::new([a, a + b], [c, c + d]).unwrap());
        let workspace = Workspace { tool, mode, limits, margin };
        let map = Map::new(workspace, grid(&tool, 150.0));
        for branch in Side::BOTH {
            let Some(rectangle) = map.largest_rectangle(branch) else {
                prop_assert!(map.areas(branch).admitted < 300.0 * map.grid().pitch().powi(2));
                continue;
            };
            let size = rectangle.size();
            for &(across, up) in &shares {
                let t = rectangle.low + Vec2::new(size.x * across, size.y * up);
                let pose = workspace.admit(t);
                prop_assert!(pose.is_ok_and(|pose| pose.assembly() == branch), "{t:?} in {rectangle:?}");
            }
            for larger in grown(rectangle, map.grid().pitch()) {
                prop_assert!(!is_free(&workspace, larger, branch), "{larger:?}");
            }
        }
    }
}

/// The tool with both driven joints turned a little.
fn at(tool: &Tool<f64>, pose: &Pose<f64>, [turn1, turn4]: [f64; 2]) -> Vec2<f64> {
    let [theta1, _, _, theta4] = pose.angles();
    let moved = tool
        .geometry()
        .forward(theta1 + turn1, theta4 + turn4, pose.assembly());
    tool.point(&moved.unwrap())
}

/// How far a point is from a chord.
fn distance(point: Vec2<f64>, [from, to]: [Vec2<f64>; 2]) -> f64 {
    let way = to - from;
    let share = (point - from).dot(way) / way.norm_squared().max(1e-30);
    (from + way * share.clamp(0.0, 1.0) - point).norm()
}

/// A rectangle with one side moved outwards.
fn grown(rectangle: Rectangle, by: f64) -> [Rectangle; 4] {
    let Rectangle { low, high } = rectangle;
    let (x, y) = (Vec2::new(by, 0.0), Vec2::new(0.0, by));
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

/// Whether every place of a fine raster over a rectangle is admitted on a branch.
fn is_free(workspace: &Workspace<f64>, rectangle: Rectangle, branch: Side) -> bool {
    let size = rectangle.size();
    (0..=400).all(|i| {
        (0..=400).all(|j| {
            let share = [f64::from(i) / 400.0, f64::from(j) / 400.0];
            let t = rectangle.low + Vec2::new(size.x * share[0], size.y * share[1]);
            let pose = workspace.admit(t);
            pose.is_ok_and(|pose| pose.assembly() == branch)
        })
    })
}

#[test]
fn limits_and_margin_take_their_share_of_the_benchtop() {
    let workspace = benchtop();
    let map = Map::new(workspace, grid(&workspace.tool, 600.0));
    let left = map.areas(Side::Left);
    assert!(left.admitted < left.within_limits && left.within_limits < left.reached);
    assert!(left.admitted > 0.0);
    let (place, best) = map.best(Side::Left).unwrap();
    assert!(best.admitted && best.inverse_condition > 0.9, "{best:?}");
    assert_close("symmetric", place.x, 0.04, 0.01);
    let others = map
        .reached()
        .filter(|(_, cell)| cell.admitted && cell.assembly == Side::Left);
    for (_, cell) in others {
        assert!(cell.inverse_condition <= best.inverse_condition);
    }
}

#[test]
fn an_arm_that_reaches_one_point_has_a_map_of_one_cell_at_most() {
    // The base is as long as all the links together.
    let geometry = Geometry::new([0.1, 0.1, 0.1, 0.1, 0.4]).unwrap();
    let tool = Tool::new(geometry, Vec2::zero()).unwrap();
    for mode in WorkingMode::ALL {
        let map = Map::new(unbounded(tool, mode), Grid::over(&tool, 1e-3).unwrap());
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
    let [low, high] = bounds(
        &Tool::new(
            Geometry::new([0.1, 0.1, 0.1, 0.1, 0.24]).unwrap(),
            Vec2::zero(),
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
