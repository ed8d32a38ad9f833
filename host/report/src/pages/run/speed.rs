//! The drawing coloured by the speed of the reference.

use super::RunReport;
use super::motion::path_samples;
use crate::html::{BANDS, BoundingBox, Page, Point};
use crate::text::quantity;
use fivebar_sim::simulation::Sample;
use std::fmt::Write as _;

/// Width of the picture, and the air around the drawing [px].
const WIDTH: f64 = 760.0;
const AIR: f64 = 12.0;

/// A part of the drawing at about one speed.
struct BandedPath {
    band: usize,
    points: Vec<Point>,
}

impl RunReport<'_> {
    /// Adds the drawing in ten colours, from rest to its greatest speed.
    pub(super) fn add_speed(&self, page: &mut Page) {
        let samples: Vec<&Sample> = path_samples(self.trace.samples()).collect();
        let pairs = samples
            .windows(2)
            .filter(|pair| self.draws(pair[0]) && self.draws(pair[1]));
        let steps: Vec<(f64, [Point; 2])> = pairs
            .map(|pair| {
                let [from, to] = [pair[0], pair[1]].map(|sample| sample.reference);
                let distance = (to[0] - from[0]).hypot(to[1] - from[1]);
                (distance / (pair[1].time - pair[0].time), [from, to])
            })
            .filter(|(speed, _)| speed.is_finite())
            .collect();
        let fastest = steps.iter().map(|(speed, _)| *speed).fold(0.0, f64::max);
        let ends = steps.iter().flat_map(|(_, ends)| ends);
        let Some(range) = BoundingBox::of(ends).filter(|_| fastest > 0.0) else {
            return;
        };
        let scale = (WIDTH - 2.0 * AIR) / range.width().max(range.height());
        let height = 2.0 * AIR + scale * range.height();
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.0}\" role=\"img\" \
             aria-label=\"The drawing by its speed\" fill=\"none\" stroke-width=\"2.5\" \
             stroke-linecap=\"round\" stroke-linejoin=\"round\">\n"
        );
        for BandedPath { band, points } in stretches(&steps, fastest) {
            let [red, green, blue] = BANDS[band];
            let _ = write!(
                svg,
                "<polyline stroke=\"#{red:02x}{green:02x}{blue:02x}\" points=\""
            );
            for [x, y] in points {
                let x = AIR + scale * (x - range.low[0]);
                let y = height - AIR - scale * (y - range.low[1]);
                let _ = write!(svg, "{x:.1},{y:.1} ");
            }
            svg.push_str("\"/>\n");
        }
        svg.push_str("</svg>");
        page.heading("Speed").figure(
            &svg,
            &format!(
                "From dark at rest to bright at {}/s, in ten steps.",
                quantity(fastest, "m")
            ),
        );
    }
}

/// The steps, those of one colour that follow one another as one.
fn stretches(steps: &[(f64, [Point; 2])], fastest: f64) -> Vec<BandedPath> {
    let mut all: Vec<BandedPath> = Vec::new();
    for &(speed, [from, to]) in steps {
        let band = ((BANDS.len() as f64 * speed / fastest) as usize).min(BANDS.len() - 1);
        match all.last_mut() {
            Some(last) if last.band == band && last.points.last() == Some(&from) => {
                last.points.push(to);
            }
            _ => all.push(BandedPath {
                band,
                points: vec![from, to],
            }),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_one_colour_are_one_line_and_gaps_divide_them() {
        let step = |speed: f64, from: f64| (speed, [[from, 0.0], [from + 1.0, 0.0]]);
        let steps = [
            step(0.1, 0.0),
            step(0.11, 1.0),
            step(1.0, 2.0),
            step(1.0, 5.0),
        ];
        let found: Vec<(usize, usize)> = stretches(&steps, 1.0)
            .iter()
            .map(|stretch| (stretch.band, stretch.points.len()))
            .collect();
        assert_eq!(found, [(1, 3), (9, 2), (9, 2)]);
    }
}
