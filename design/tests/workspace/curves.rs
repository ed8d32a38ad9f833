//! Singularity curves, and the determinant whose zeros they are.

use crate::arms::{assembly, grid, segments, tool, unbounded};
use fivebar_design::workspace::{SingularityCurve, WorkspaceMap, reach_bounds, singularity_curves};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{
    Geometry, Pose, Side, Singularity, Tool, WorkingMode, Workspace,
};
use fivebar_testkit::{Tally, mode};
use nalgebra::Vector2;
use proptest::prelude::*;

/// ½∮(x dy − y dx) around a branch, along the singularity curves at its boundary. Positions 10 pm
/// beside both ends of a chord show which side of the chord is in the branch. Two curves can touch
/// each other so closely that a branch is thinner than 10 nm over centimetres; a thousand times less
/// is still far above the rounding of a position.
fn enclosed_area(workspace: &Workspace<f64>, curves: &[SingularityCurve], branch: Side) -> f64 {
    let inside = |t| f64::from(u8::from(assembly(workspace, t) == Some(branch)));
    let chords = curves.iter().flat_map(segments).map(|[from, to]| {
        let across = (to - from).perpendicular() * (1e-11 / (to - from).length().max(1e-15));
        let borders = |end| inside(end + across) - inside(end - across);
        0.5 * from.cross_z(to) * 0.5 * (borders(from) + borders(to))
    });
    chords.sum()
}

#[test]
fn the_textbook_arm_loses_hold_where_the_literature_says() {
    let geometry = Geometry::new([0.23, 0.23, 0.23, 0.23, 0.275]).unwrap();
    let tool = Tool::new(geometry, Vector2::zeros()).unwrap();
    // Elbows out, in the middle: links 2 and 3 in line, C 0.21057956 above the base.
    let curves = singularity_curves(&tool, WorkingMode::new(Side::Right, Side::Left));
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
    let b = Vector2::unit(53.285_64_f64.to_radians()) * 0.23;
    let curves = singularity_curves(&tool, WorkingMode::new(Side::Left, Side::Right));
    let on_circle = curves.iter().flat_map(|curve| &curve.points);
    let on_circle = on_circle
        .filter(|&&c| ((c - b).length() - 0.23).abs() < 1e-7)
        .count();
    assert!(on_circle > 20, "{on_circle} points");
}

/// The singularity curves enclose the area of each branch.
fn assert_enclosed(tool: Tool<f64>, mode: WorkingMode) -> Result<(), TestCaseError> {
    let workspace = unbounded(tool, mode);
    let grid = grid(&tool, 300.0);
    let map = WorkspaceMap::new(workspace, grid);
    let curves = singularity_curves(&tool, mode);
    let length: f64 = curves
        .iter()
        .flat_map(segments)
        .map(|[a, b]| (b - a).length())
        .sum();
    for branch in Side::BOTH {
        let counted = map.areas(branch).reached;
        let enclosed = enclosed_area(&workspace, &curves, branch);
        let bound = (0.2 * length + 10.0 * grid.pitch()) * grid.pitch();
        prop_assert!(
            (counted - enclosed).abs() < bound,
            "{branch:?}: {counted} for {enclosed} m²"
        );
    }
    Ok(())
}

/// Arms for which random tests once found an error, each with its tool beside C.
const FOUND: [([f64; 5], [f64; 2]); 3] = [
    // The second link is short.
    (
        [
            0.432_297_010_375_151_56,
            0.094_291_510_644_627_74,
            0.464_836_904_883_290_5,
            0.438_658_074_168_449_8,
            0.393_186_240_650_236_2,
        ],
        [0.0, 0.0],
    ),
    // A branch is thinner than 10 nm over 16 mm.
    (
        [
            0.359_466_660_642_012_5,
            0.057_277_141_777_692_935,
            0.107_846_542_424_899_15,
            0.133_217_222_752_786_77,
            0.087_213_425_181_901_5,
        ],
        [0.004_998_614_713_549_614, 0.028_543_439_731_001_853],
    ),
    // Nearly a parallelogram: within half a degree of a curve's angle the tool moves by 0.3 m.
    (
        [
            0.463_034_543_217_403_67,
            0.056_547_047_761_954_29,
            0.401_398_332_920_297_3,
            0.462_817_103_910_601_7,
            0.457_952_375_759_802_63,
        ],
        [-0.002_180_891_555_368_989_4, -0.023_938_394_848_674_594],
    ),
];

#[test]
fn the_curves_of_known_arms_enclose_their_areas() {
    for (lengths, [along, left]) in FOUND {
        let geometry = Geometry::new(lengths).unwrap();
        let tool = Tool::new(geometry, Vector2::new(along, left)).unwrap();
        for elbow1 in Side::BOTH {
            for elbow4 in Side::BOTH {
                assert_enclosed(tool, WorkingMode::new(elbow1, elbow4)).unwrap();
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn the_bounds_hold_all_that_is_reached(tool in tool(), mode in mode()) {
        let [low, high] = reach_bounds(&tool);
        let curves = singularity_curves(&tool, mode);
        let points = || curves.iter().flat_map(|curve| &curve.points);
        prop_assert!(points().count() > 4);
        for point in points() {
            prop_assert!(low.x - 1e-12 <= point.x && point.x <= high.x + 1e-12, "{point:?}");
            prop_assert!(low.y - 1e-12 <= point.y && point.y <= high.y + 1e-12, "{point:?}");
        }
    }

    #[test]
    fn singularity_curves_enclose_the_area_of_each_branch(tool in tool(), mode in mode()) {
        assert_enclosed(tool, mode)?;
    }

    #[test]
    fn the_tools_jacobian_is_its_derivative((tool, pose) in regular_poses()) {
        let jacobian = tool.jacobian(&pose).unwrap();
        let moved = |h: [f64; 2]| at(&tool, &pose, h);
        let h = 1e-6;
        // Differences of fourth order: near a singularity the error of second order is too great.
        let column = |x: f64, y: f64| {
            let across = |k: f64| (moved([k * x, k * y]) - moved([-k * x, -k * y])) * (0.5 / (k * h));
            (across(1.0) * 4.0 - across(2.0)) * (1.0 / 3.0)
        };
        let columns = [column(h, 0.0), column(0.0, h)];
        let scale = jacobian.singular_values()[0].max(1.0);
        for (exact, found) in [jacobian.c1, jacobian.c4].into_iter().zip(columns) {
            prop_assert!(exact.length() > 1e-4);
            prop_assert!((exact - found).length() < 1e-7 * scale, "{found:?} for {exact:?}");
        }
        let matrix = nalgebra::Matrix2::new(columns[0].x, columns[1].x, columns[0].y, columns[1].y);
        let values = matrix.singular_values();
        let expected = values.min() / values.max();
        prop_assert!((jacobian.inverse_condition() - expected).abs() < 1e-6);
    }
}

/// A pose of any tool, well away from its singularities.
fn regular_poses() -> impl Strategy<Value = (Tool<f64>, Pose<f64>)> {
    let place = (-0.5..0.5_f64, -0.5..0.5_f64);
    (tool(), mode(), place).prop_filter_map("no regular pose", |(tool, mode, (x, y))| {
        let pose = tool.inverse(Vector2::new(x, y), mode).ok()?;
        (tool.nearest_singularity(&pose).1 > 0.1).then_some((tool, pose))
    })
}

#[test]
fn every_curve_is_where_its_sine_vanishes() {
    let reached = Tally::default();
    proptest!(ProptestConfig::with_cases(48), |(tool in tool(), mode in mode())| {
        prop_assert!(!singularity_curves(&tool, mode).is_empty());
        for curve in singularity_curves(&tool, mode) {
            prop_assert!(curve.points.len() > 1);
            for point in &curve.points {
                // A position that is out of reach by rounding has no pose.
                let pose = tool.inverse(*point, mode);
                if !reached.count(pose.is_ok()) {
                    continue;
                }
                let pose = pose.unwrap();
                let [sine1, sine4] = tool.elbow_sines(&pose);
                let sine = match curve.singularity {
                    Singularity::Leg1 => sine1,
                    // Where another leg is singular too, this sine is not accurate.
                    Singularity::Leg4 => sine4 * sine1.abs(),
                    Singularity::Parallel => pose.sin32() * (sine1 * sine4).abs(),
                };
                prop_assert!(sine.abs() < 1e-6, "{sine} at {point:?}, {:?}", curve.singularity);
            }
        }
    });
    reached.assert_accepted(0.99);
}

#[test]
fn a_curve_lies_wherever_the_determinant_changes_sign() {
    let compared = Tally::default();
    proptest!(ProptestConfig::with_cases(48), |(tool in tool(), mode in mode())| {
        let map = WorkspaceMap::new(unbounded(tool, mode), grid(&tool, 120.0));
        let curves = singularity_curves(&tool, mode);
        let in_line = curves.iter().filter(|c| c.singularity == Singularity::Parallel);
        let chords: Vec<_> = in_line.flat_map(segments).collect();
        let (columns, pitch) = (map.grid().columns(), map.grid().pitch());
        for (index, cell) in map.cells().iter().enumerate() {
            for next in [index + 1, index + columns] {
                let (Some(one), Some(Some(other))) = (cell, map.cells().get(next)) else { continue };
                if next % columns == 0 || one.assembly == other.assembly { continue }
                prop_assert!(one.sin32 * other.sin32 <= 0.0);
                let displacement = map.grid().cell_centre(next) - map.grid().cell_centre(index);
                let between = |step: u32| map.grid().cell_centre(index) + displacement * (f64::from(step) / 64.0);
                if !compared.count((0..64).all(|step| assembly(map.workspace(), between(step)).is_some())) {
                    continue;
                }
                let middle = (map.grid().cell_centre(index) + map.grid().cell_centre(next)) * 0.5;
                // A chord is within half its length of its curve, for any curvature.
                let [nearest, half] = chords
                    .iter()
                    .map(|&[from, to]| [distance(middle, [from, to]), 0.5 * (to - from).length()])
                    .min_by(|a, b| (a[0] - a[1]).total_cmp(&(b[0] - b[1])))
                    .unwrap_or([1.0, 0.0]);
                prop_assert!(nearest < 0.51 * pitch + half, "{nearest} m from {middle:?}");
            }
        }
        // A curve of some length has different branches on its two sides.
        let length: f64 = chords.iter().map(|[a, b]| (*b - *a).length()).sum();
        let changes = chords.iter().filter(|[from, to]| {
            let across = (*to - *from).perpendicular() * (1e-7 / (*to - *from).length().max(1e-12));
            let sides = [*from + across, *from - across].map(|t| assembly(map.workspace(), t));
            matches!(sides, [Some(one), Some(other)] if one != other)
        });
        let share = changes.count() as f64 / chords.len().max(1) as f64;
        prop_assert!(share > 0.5 || length < 20.0 * pitch, "{length} m of curve, {share} of it with a change");
    });
    compared.assert_accepted(0.95);
    assert!(compared.accepted() > 1000);
}

/// The tool's position with both driven joints turned by these angles [rad].
fn at(tool: &Tool<f64>, pose: &Pose<f64>, [turn1, turn4]: [f64; 2]) -> Vector2<f64> {
    let [theta1, _, _, theta4] = pose.angles();
    let moved = tool
        .geometry()
        .forward(theta1 + turn1, theta4 + turn4, pose.assembly());
    tool.point(&moved.unwrap())
}

/// The distance of a point from a chord.
fn distance(point: Vector2<f64>, [from, to]: [Vector2<f64>; 2]) -> f64 {
    let displacement = to - from;
    let share = (point - from).dot(&displacement) / displacement.length_squared().max(1e-30);
    (from + displacement * share.clamp(0.0, 1.0) - point).length()
}
