//! Fills as hatches: parallel lines at 45°, a distance apart, where the fill's rule says inside.
//!
//! Turned by −45°, the lines are level. Each edge of the outlines crosses the lines between its ends, upwards or
//! downwards; from left to right the sum of these signs is the winding number. All fills of a drawing have the
//! same lines, so an opaque fill takes its part of a line away from the fills below it.

use super::super::drawing::Stroke;
use crate::budget::{Budget, OverBudget};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_1_SQRT_2;
use usvg::FillRule;

/// Lines shorter than this share of their distance are left out.
const SHORTEST: f64 = 0.1;

/// A part of a line inside a fill, along the line [m], and the number of the fill.
#[derive(Clone, Copy)]
struct Span {
    from: f64,
    to: f64,
    fill: usize,
}

/// Fills areas with lines.
pub(super) struct Hatch {
    /// Distance of the lines [m].
    distance: f64,
    /// The parts of each line.
    spans: BTreeMap<i64, Vec<Span>>,
    /// Crossings of edges and lines, and parts of lines that fills are compared with.
    budget: Budget,
}

impl Hatch {
    pub(super) fn new(distance: f64) -> Self {
        Self {
            distance,
            spans: BTreeMap::new(),
            budget: Budget::hatch(),
        }
    }

    /// Fills the inside of closed outlines [m]. An opaque fill hides what lies below it. Without a number the
    /// fill is as white as the page, and has no lines of its own.
    pub(super) fn fill(
        &mut self,
        outlines: &[Stroke],
        rule: FillRule,
        number: Option<usize>,
        is_opaque: bool,
    ) -> Result<(), OverBudget> {
        let crossings = self.crossings(outlines)?;
        let mut winding = 0;
        for pair in crossings.windows(2) {
            let [(line, from, sign), (_, to, _)] = [pair[0], pair[1]];
            // Closed outlines end each line with 0.
            winding += sign;
            let is_inside = match rule {
                FillRule::NonZero => winding != 0,
                FillRule::EvenOdd => winding % 2 != 0,
            };
            if !is_inside || from >= to {
                continue;
            }
            let spans = self.spans.entry(line).or_default();
            if is_opaque {
                self.budget.take(spans.len())?;
                hide(spans, from, to);
            }
            spans.extend(number.map(|fill| Span { from, to, fill }));
        }
        Ok(())
    }

    /// Where edges of outlines cross lines, in the order of the lines and along them: the line, the place along
    /// it [m], and +1 for an edge that goes upwards.
    fn crossings(&mut self, outlines: &[Stroke]) -> Result<Vec<(i64, f64, i32)>, OverBudget> {
        let level = |[x, y]: [f64; 2]| [FRAC_1_SQRT_2 * (x + y), FRAC_1_SQRT_2 * (y - x)];
        let mut crossings = Vec::new();
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
                let first = (low[1] / self.distance).ceil();
                let end = (high[1] / self.distance).ceil();
                self.budget.take_calculated(end - first)?;
                crossings.extend((first as i64..end as i64).map(|line| {
                    let v = line as f64 * self.distance;
                    let share = (v - low[1]) / (high[1] - low[1]);
                    (line, low[0] + share * (high[0] - low[0]), sign)
                }));
            }
        }
        crossings.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        Ok(crossings)
    }

    /// The lines that are seen, each with the number of its fill.
    pub(super) fn into_lines(self) -> impl Iterator<Item = (usize, Stroke)> {
        let distance = self.distance;
        let back = |[u, v]: [f64; 2]| [FRAC_1_SQRT_2 * (u - v), FRAC_1_SQRT_2 * (u + v)];
        let of_line = move |(line, spans): (i64, Vec<Span>)| {
            let v = line as f64 * distance;
            let seen = spans
                .into_iter()
                .filter(move |span| span.to - span.from > SHORTEST * distance);
            seen.map(move |span| (span.fill, vec![back([span.from, v]), back([span.to, v])]))
        };
        self.spans.into_iter().flat_map(of_line)
    }
}

/// Takes a part of a line away from the spans on it.
fn hide(spans: &mut Vec<Span>, from: f64, to: f64) {
    let mut behind = Vec::new();
    for span in spans.iter_mut() {
        if span.to <= from || to <= span.from {
            continue;
        }
        if span.to > to {
            behind.push(Span { from: to, ..*span });
        }
        // Nothing is left of a span that begins inside.
        span.to = from.max(span.from);
    }
    spans.retain(|span| span.from < span.to);
    spans.append(&mut behind);
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

    /// Length of the lines of each of two fills times their distance [m²].
    fn areas(hatch: Hatch) -> [f64; 2] {
        let mut areas = [0.0; 2];
        for (fill, line) in hatch.into_lines() {
            let [[x0, y0], [x1, y1]] = [line[0], line[1]];
            assert!(((y1 - y0) - (x1 - x0)).abs() < 1e-12, "at 45°: {line:?}");
            areas[fill] += 1e-4 * (x1 - x0).hypot(y1 - y0);
        }
        areas
    }

    fn area(outlines: &[Vec<[f64; 2]>], rule: FillRule) -> f64 {
        let mut hatch = Hatch::new(1e-4);
        hatch.fill(outlines, rule, Some(0), true).unwrap();
        areas(hatch)[0]
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
    fn an_opaque_fill_hides_what_lies_below_it_and_no_other_does() {
        for (upper, is_opaque, expected) in [
            (None, true, [0.0075, 0.0]),
            (Some(1), true, [0.0075, 0.0025]),
            (Some(1), false, [0.01, 0.0025]),
        ] {
            let mut hatch = Hatch::new(1e-4);
            let lower = [SQUARE.to_vec()];
            hatch
                .fill(&lower, FillRule::NonZero, Some(0), true)
                .unwrap();
            let above = [inner(false)];
            hatch
                .fill(&above, FillRule::NonZero, upper, is_opaque)
                .unwrap();
            for (found, expected) in areas(hatch).into_iter().zip(expected) {
                assert!(
                    (found - expected).abs() < 2e-6,
                    "{upper:?} {is_opaque} {found}"
                );
            }
        }
    }

    #[test]
    fn a_hatch_of_too_many_lines_is_refused() {
        let fill = |distance, outlines: &[Vec<[f64; 2]>]| {
            let mut hatch = Hatch::new(distance);
            hatch.fill(outlines, FillRule::NonZero, Some(0), true)?;
            Ok::<_, super::OverBudget>(hatch.into_lines().count())
        };
        assert!(fill(1e-7, &[SQUARE.to_vec()]).is_err());
        assert_eq!(fill(1e-3, &[vec![[0.01, 0.02]], vec![]]), Ok(0));
    }
}
