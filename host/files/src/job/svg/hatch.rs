//! Fills as hatches: parallel lines at 45°, a distance apart, where the fill's rule says inside.
//!
//! Turned by −45°, the lines are level. Each edge of the outlines crosses the lines between its ends, upwards or
//! downwards; from left to right the sum of these signs is the winding number.

use super::super::drawing::Stroke;
use std::f64::consts::FRAC_1_SQRT_2;
use usvg::FillRule;

/// Most lines of a drawing.
const MOST_LINES: usize = 200_000;
/// Lines shorter than this share of their distance are left out.
const SHORTEST: f64 = 0.1;

/// Fills areas with lines.
pub(super) struct Hatch {
    /// Distance of the lines [m].
    distance: f64,
    lines: usize,
}

impl Hatch {
    pub(super) fn new(distance: f64) -> Self {
        Self { distance, lines: 0 }
    }

    /// The lines inside the outlines [m], which are closed. None if there are too many lines.
    pub(super) fn lines(&mut self, outlines: &[Stroke], rule: FillRule) -> Option<Vec<Stroke>> {
        let level = |[x, y]: [f64; 2]| [FRAC_1_SQRT_2 * (x + y), FRAC_1_SQRT_2 * (y - x)];
        let back = |[u, v]: [f64; 2]| [FRAC_1_SQRT_2 * (u - v), FRAC_1_SQRT_2 * (u + v)];
        // Where an edge crosses a line: the line, u, and +1 upwards.
        let mut crossings: Vec<(i64, f64, i32)> = Vec::new();
        for outline in outlines {
            let next = outline.iter().cycle().skip(1);
            for (&from, &to) in outline.iter().zip(next) {
                let (from, to) = (level(from), level(to));
                let (low, high, sign) = if from[1] < to[1] {
                    (from, to, 1)
                } else {
                    (to, from, -1)
                };
                // A line through a corner belongs to the edge that begins there.
                let first = (low[1] / self.distance).ceil() as i64;
                let end = (high[1] / self.distance).ceil() as i64;
                self.lines = self
                    .lines
                    .saturating_add((end - first).unsigned_abs() as usize);
                if self.lines > 2 * MOST_LINES {
                    return None;
                }
                crossings.extend((first..end).map(|line| {
                    let v = line as f64 * self.distance;
                    let share = (v - low[1]) / (high[1] - low[1]);
                    (line, low[0] + share * (high[0] - low[0]), sign)
                }));
            }
        }
        crossings.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut strokes = Vec::new();
        let mut winding = 0;
        for pair in crossings.windows(2) {
            let [(line, from, sign), (_, to, _)] = [pair[0], pair[1]];
            // Closed outlines end each line with 0.
            winding += sign;
            let is_inside = match rule {
                FillRule::NonZero => winding != 0,
                FillRule::EvenOdd => winding % 2 != 0,
            };
            if is_inside && to - from > SHORTEST * self.distance {
                let v = line as f64 * self.distance;
                strokes.push(vec![back([from, v]), back([to, v])]);
            }
        }
        Some(strokes)
    }
}

#[cfg(test)]
mod tests {
    use super::{FillRule, Hatch};

    const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]];

    fn inner(reversed: bool) -> Vec<[f64; 2]> {
        let mut square = SQUARE.map(|p| p.map(|x| 0.025 + 0.5 * x)).to_vec();
        if reversed {
            square.reverse();
        }
        square
    }

    /// Length of the lines times their distance [m²].
    fn area(outlines: &[Vec<[f64; 2]>], rule: FillRule) -> f64 {
        let lines = Hatch::new(1e-4).lines(outlines, rule).unwrap();
        let lengths = lines.iter().map(|line| {
            let [[x0, y0], [x1, y1]] = [line[0], line[1]];
            assert!(((y1 - y0) - (x1 - x0)).abs() < 1e-12, "at 45°: {line:?}");
            (x1 - x0).hypot(y1 - y0)
        });
        1e-4 * lengths.sum::<f64>()
    }

    #[test]
    fn the_lines_cover_the_area_that_the_rule_fills() {
        let whole = vec![SQUARE.to_vec()];
        assert!((area(&whole, FillRule::NonZero) - 0.01).abs() < 2e-6);
        for reversed in [false, true] {
            let both = vec![SQUARE.to_vec(), inner(reversed)];
            assert!((area(&both, FillRule::EvenOdd) - 0.0075).abs() < 2e-6);
            let filled = if reversed { 0.0075 } else { 0.01 };
            assert!((area(&both, FillRule::NonZero) - filled).abs() < 2e-6);
        }
        let circle: Vec<_> = (0..720).map(|i| f64::from(i).to_radians() / 2.0).collect();
        let circle = circle
            .iter()
            .map(|t| [0.05 * t.cos(), 0.05 * t.sin()])
            .collect();
        let expected = std::f64::consts::PI * 0.0025;
        assert!((area(&[circle], FillRule::NonZero) / expected - 1.0).abs() < 2e-4);
    }

    #[test]
    fn a_hatch_of_too_many_lines_is_refused() {
        assert!(
            Hatch::new(1e-7)
                .lines(&[SQUARE.to_vec()], FillRule::NonZero)
                .is_none()
        );
        let point = vec![vec![[0.01, 0.02]], vec![]];
        assert_eq!(
            Hatch::new(1e-3).lines(&point, FillRule::NonZero),
            Some(vec![])
        );
    }
}
