//! Arcs as files print them: with three or four decimals of a millimetre, or of an inch. They must lie along the arc
//! that was rounded, however short their chords are.

use crate::placed::{job, refusal};
use fivebar_files::job::{Action, GcodeError};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// A motion as a file prints it, and the arc that it was before it was rounded [file's units].
#[derive(Clone, Copy, Debug)]
struct True {
    center: [f64; 2],
    radius: f64,
    start: f64,
    sweep: f64,
    clockwise: bool,
}

impl True {
    fn at(&self, share: f64) -> [f64; 2] {
        let sign = if self.clockwise { -1.0 } else { 1.0 };
        let (sin, cos) = (self.start + sign * share * self.sweep).sin_cos();
        [
            self.center[0] + self.radius * cos,
            self.center[1] + self.radius * sin,
        ]
    }

    /// The code of the motion, with I and J or with R.
    fn code(&self, unit: &str, decimals: usize, by_radius: bool) -> String {
        let [[x0, y0], [x1, y1]] = [self.at(0.0), self.at(1.0)];
        let [i, j] = [self.center[0] - x0, self.center[1] - y0];
        let code = if self.clockwise { 2 } else { 3 };
        let form = match by_radius {
            true => format!("R{:.decimals$}", self.radius),
            false => format!("I{i:.decimals$} J{j:.decimals$}"),
        };
        format!(
            "{unit} F600\nG0 X{x0:.decimals$} Y{y0:.decimals$}\n\
             G{code} X{x1:.decimals$} Y{y1:.decimals$} {form}\n"
        )
    }
}

/// Points along the arcs of a job, in equal shares of their length [m].
fn points(text: &str) -> Vec<[f64; 2]> {
    let mut at = [0.0; 2];
    let mut dense = vec![];
    for step in job(text).steps {
        match step.action {
            Action::Arc {
                to,
                center,
                clockwise,
                ..
            } => {
                let [dx, dy] = [at[0] - center[0], at[1] - center[1]];
                let first = dy.atan2(dx);
                let last = (to[1] - center[1]).atan2(to[0] - center[0]);
                let sign = if clockwise { -1.0 } else { 1.0 };
                let mut sweep = (sign * (last - first)).rem_euclid(TAU);
                if to == at {
                    sweep = TAU;
                }
                dense.extend((0..=1000).map(|step| {
                    let angle = first + sign * sweep * f64::from(step) / 1000.0;
                    let radius = dx.hypot(dy);
                    [
                        center[0] + radius * angle.cos(),
                        center[1] + radius * angle.sin(),
                    ]
                }));
                at = to;
            }
            Action::Line { to, .. } => at = to,
            other => panic!("{other:?}"),
        }
    }
    dense
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The greatest distance of the true arc from what is drawn, and of that from the arc, in roundings.
fn deviation(arc: &True, text: &str, metres: f64, decimals: usize) -> f64 {
    let rounding = 0.5 * metres * 10_f64.powi(-(decimals as i32));
    let drawn = points(text);
    let wanted = (0..=1000).map(|step| arc.at(f64::from(step) / 1000.0).map(|x| metres * x));
    let wanted: Vec<_> = wanted.collect();
    // Between neighbouring samples the arcs differ from their chords by less.
    let sample = metres * arc.radius * TAU / 1000.0;
    let far = |from: &[[f64; 2]], to: &[[f64; 2]]| {
        let nearest = |point: [f64; 2]| {
            let index = to
                .iter()
                .enumerate()
                .map(|(index, &other)| (index, distance(point, other)))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .map_or(0, |(index, _)| index);
            let ends = [
                index.saturating_sub(1),
                index,
                (index + 1).min(to.len() - 1),
            ];
            let segment = |a: [f64; 2], b: [f64; 2]| {
                let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
                let square = dx * dx + dy * dy;
                let along = ((point[0] - a[0]) * dx + (point[1] - a[1]) * dy) / square;
                let along = if square > 0.0 {
                    along.clamp(0.0, 1.0)
                } else {
                    0.0
                };
                distance(point, [a[0] + along * dx, a[1] + along * dy])
            };
            segment(to[ends[0]], to[ends[1]]).min(segment(to[ends[1]], to[ends[2]]))
        };
        from.iter()
            .step_by(50)
            .map(|&point| nearest(point))
            .fold(0.0, f64::max)
    };
    let sagitta = sample * sample / (8.0 * metres * arc.radius);
    (far(&drawn, &wanted).max(far(&wanted, &drawn)) - sagitta).max(0.0) / rounding
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn a_rounded_arc_by_its_centre_lies_within_a_few_roundings_of_the_arc(
        x in -50.0..50.0_f64,
        y in -50.0..50.0_f64,
        radius in prop_oneof![0.05..0.5_f64, 0.5..50.0_f64],
        start in 0.0..TAU,
        // Sweeps of few roundings are a dot or a full turn, by the side to which the end is rounded.
        rest in prop_oneof![0.0..1.0_f64, 0.99..1.0_f64],
        clockwise: bool,
        is_inch: bool,
        decimals in 3_usize..5,
    ) {
        let least = 4.0 * 10_f64.powi(-(decimals as i32)) / radius;
        let sweep = least + rest * (TAU - 2.0 * least);
        let arc = True { center: [x, y], radius, start, sweep, clockwise };
        let (unit, metres) = if is_inch { ("G20", 25.4e-3) } else { ("G21", 1e-3) };
        let text = arc.code(unit, decimals, false);
        let far = deviation(&arc, &text, metres, decimals);
        prop_assert!(far < 6.0, "{far} roundings: {text}");
    }

    #[test]
    fn a_rounded_arc_by_its_radius_lies_within_a_few_roundings_times_its_leverage(
        radius in 0.05..50.0_f64,
        start in 0.0..TAU,
        sweep in 0.3..3.1_f64,
        clockwise: bool,
        decimals in 3_usize..5,
    ) {
        let arc = True { center: [1.0, 2.0], radius, start, sweep, clockwise };
        let text = arc.code("G21", decimals, true);
        let far = deviation(&arc, &text, 1e-3, decimals);
        // Near half a turn, the height of the centre over the chord is the root of what was rounded.
        let height = (radius * (0.5 * sweep).cos()).max((4e-3 * radius).sqrt());
        prop_assert!(far < 8.0 * (1.0 + radius / height), "{far} roundings: {text}");
    }
}

#[test]
fn a_circle_whose_end_is_printed_beside_its_start_is_a_full_circle() {
    for end in ["X10.001 Y0", "X9.999 Y0", "X10.002 Y0", "X10 Y0.001"] {
        let text = format!("G21 G90 F600\nG0 X10 Y0\nG2 {end} I-5 J0\nM2\n");
        let drawn = points(&text);
        let beside = |point: &[f64; 2]| (distance(*point, [5e-3, 0.0]) - 5e-3).abs();
        assert!(drawn.iter().map(beside).all(|far| far < 2.1e-6), "{end}");
        let length: f64 = drawn
            .windows(2)
            .map(|pair| distance(pair[0], pair[1]))
            .sum();
        assert!((length - TAU * 5e-3).abs() < 1e-5, "{end}: {length} m");
    }
}

#[test]
fn an_arc_by_a_radius_that_was_rounded_below_half_its_chord_is_a_half_circle() {
    let text = "G21 G90\nG0 X0 Y0\nG1 X10 Y0 F600\nG3 X10.002 Y0.005 R0.002\nG1 X20 Y10\nM2\n";
    let steps = job(text).steps;
    assert_eq!(steps.len(), 4);
    let Action::Arc { to, center, .. } = steps[2].action else {
        panic!("{:?}", steps[2]);
    };
    assert!(distance(to, [10.002e-3, 5e-6]) < 1e-12);
    assert!(distance(center, [10.001e-3, 2.5e-6]) < 1e-12);
    // A radius that no rounding makes of the right one is refused.
    let (line, reason) = refusal("F600\nG3 X10 Y0 R4.9");
    assert!(line == 2 && reason == GcodeError::ArcChord);
}
