//! Runs of many turns and bends: they keep their limits as short ones do.

use super::shared::{arm, driven, line, torque_limits};
use fivebar_design::time_optimal::{DrivenArm, PathPiece, PlanError, PlanLimits, blend, plan};
use nalgebra::Vector2;
use std::f64::consts::TAU;

fn limits() -> PlanLimits {
    PlanLimits {
        speed: [35.0; 2],
        acceleration: [1000.0; 2],
        ..torque_limits(0.75)
    }
}

fn own() -> DrivenArm {
    driven(&arm([1.0; 5], [1.0; 4], [0.0; 2]), [2e-3, 1e-2])
}

fn turns(count: f64, radius: f64) -> [PathPiece; 1] {
    let centre = Vector2::new(0.04, 0.16);
    let (start, sweep) = (0.0, TAU * count);
    [PathPiece::Arc {
        centre,
        radius,
        start,
        sweep,
    }]
}

/// Lines to and fro with a number of bends, within 50 mm.
fn zigzag(bends: usize) -> Vec<PathPiece> {
    let corner = |k: usize| {
        let y = if k.is_multiple_of(2) { 0.13 } else { 0.18 };
        Vector2::new(-0.02 + 0.12 * k as f64 / (bends + 1) as f64, y)
    };
    let lines = (0..=bends).flat_map(|k| line(corner(k), corner(k + 1)));
    lines.collect()
}

fn keeps_its_limits(pieces: &[PathPiece]) -> f64 {
    let run = plan(&own(), &limits(), pieces, None).unwrap();
    let active = run.active_time / run.time;
    assert!(run.limit_excess < 5e-3, "passed by {}", run.limit_excess);
    assert!(active > 0.95, "active for {active} of the time");
    run.time
}

#[test]
fn circles_of_many_turns_keep_their_limits_and_take_as_long_each() {
    for radius in [4e-3, 0.04] {
        let [ten, hundred] = [10.0, 100.0].map(|count| keeps_its_limits(&turns(count, radius)));
        let [each, of_more] = [ten / 10.0, hundred / 100.0];
        // Ten have a start and a stop each as often as a hundred.
        assert!(
            of_more < each && of_more > 0.97 * each,
            "{each} s and {of_more} s"
        );
    }
}

#[test]
fn many_bends_take_about_as_long_as_stops() {
    for bends in [20, 150] {
        let lines = zigzag(bends);
        let stops = |piece: &PathPiece| keeps_its_limits(std::slice::from_ref(piece));
        let with_stops: f64 = lines.iter().map(stops).sum();
        let blended = keeps_its_limits(&blend(&lines, 2e-4));
        assert!(
            blended < 1.015 * with_stops,
            "{blended} s, and {with_stops} s with stops"
        );
    }
}

#[test]
fn a_run_that_needs_too_much_memory_is_refused() {
    let error = plan(&own(), &limits(), &turns(1e6, 0.04), None).unwrap_err();
    assert!(matches!(error, PlanError::Long(_)), "{error}");
    assert!(error.to_string().contains("divide it with stops"));
}
