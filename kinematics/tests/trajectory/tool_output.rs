//! The tool's output along a planned path.

use crate::common::{MIDDLE, V, envelope, tool};
use fivebar_kinematics::trajectory::{
    LookaheadPlanner, PathSegment, ToolOutput, TrajectorySegment,
};
use proptest::prelude::*;

/// The trajectory along lines from corner to corner, each with its output.
fn planned(corners: &[V], outputs: &[f64], tolerance: f64) -> Vec<TrajectorySegment<f64>> {
    let envelope = envelope(tolerance);
    let mut lookahead = LookaheadPlanner::<f64, 16>::new();
    let mut trajectory = Vec::new();
    for ((tag, ends), &output) in (0..).zip(corners.windows(2)).zip(outputs) {
        while lookahead.free_slots() == 0 {
            trajectory.push(lookahead.next_segment().unwrap());
        }
        let line = PathSegment::line(ends[0], ends[1]).unwrap();
        let limits = envelope.check(&line, 0.1).unwrap();
        lookahead.set_tool_output(ToolOutput::constant(output));
        lookahead.push(&line, limits, tag, &envelope).unwrap();
    }
    trajectory.extend(std::iter::from_fn(|| lookahead.next_segment()));
    trajectory
}

/// The outputs in their order, each with the place where it begins.
fn changes(trajectory: &[TrajectorySegment<f64>]) -> Vec<(f64, V)> {
    let mut changes: Vec<(f64, V)> = Vec::new();
    for segment in trajectory {
        let output = segment.tool_output().at(0.0);
        if changes.last().is_none_or(|&(last, _)| last != output) {
            changes.push((output, tool(segment, 0.0).0));
        }
    }
    changes
}

proptest! {
    /// Each output begins at its corner: within the tolerance where it is rounded, and exactly
    /// there where it is not.
    #[test]
    fn outputs_change_at_the_corners(
        steps in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, -4.0..-1.5_f64), 2..20),
        straight in any::<bool>(),
        tolerance in prop::sample::select(vec![0.0, 1e-5, 1e-4]),
    ) {
        let middle = V::new(MIDDLE[0], MIDDLE[1]);
        let mut corners = vec![middle];
        for (x, y, exponent) in steps {
            let last = corners[corners.len() - 1];
            let step = if straight { V::new(2e-3, 1e-3) } else { V::new(x, y) * 10_f64.powf(exponent) };
            let next = last + step;
            corners.push(if (next - middle).norm() > 0.06 { middle } else { next });
        }
        let outputs: Vec<f64> = (1..corners.len()).map(|n| n as f64).collect();
        let changes = changes(&planned(&corners, &outputs, tolerance));
        prop_assert_eq!(changes.len(), outputs.len());
        for ((&(found, place), &output), &corner) in changes.iter().zip(&outputs).zip(&corners) {
            prop_assert_eq!(found, output);
            let off = (place - corner).norm();
            prop_assert!(off <= tolerance + 1e-9, "{off} m off the corner");
        }
    }
}

#[test]
fn a_straight_path_is_not_slowed_where_the_output_changes() {
    let corners: Vec<V> = (0..9)
        .map(|n| V::new(MIDDLE[0] + 4e-3 * f64::from(n), MIDDLE[1]))
        .collect();
    let time = |outputs: &[f64]| -> f64 {
        let trajectory = planned(&corners, outputs, 1e-4);
        trajectory.iter().map(TrajectorySegment::duration).sum()
    };
    let (same, alternating) = (
        time(&[1.0; 8]),
        time(&[1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0]),
    );
    assert!(
        (same - alternating).abs() < 1e-9,
        "{same} s, {alternating} s"
    );
}
