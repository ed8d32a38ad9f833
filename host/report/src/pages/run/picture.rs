//! A run as one still picture: the drawing, the arm at the end and in earlier poses.

use super::{RunReport, spaced};
use crate::html::{BoundingBox, Point, is_finite, thin};
use std::fmt::Write as _;

/// Width of the picture [px].
const WIDTH: f64 = 760.0;
const AIR: f64 = 24.0;
/// Number of earlier poses of the arm, which are drawn pale.
const GHOSTS: usize = 7;

const STYLE: &str = "\
    .paper{fill:#fcfcfa}.ink{stroke:#1763b6;stroke-width:1.6}\
    .arm{stroke:#1d2430;stroke-width:6}.ghost{stroke:#1d2430;stroke-width:3;opacity:.1}\
    .joint{fill:#fcfcfa;stroke:#1d2430;stroke-width:2}\
    polyline{fill:none;stroke-linecap:round;stroke-linejoin:round}\
    @media(prefers-color-scheme:dark){.paper,.joint{fill:#14181d}.ink{stroke:#6db3ff}\
    .arm,.ghost,.joint{stroke:#e4e8ee}}";

impl RunReport<'_> {
    /// The run as an SVG file; none if the trace is empty.
    pub fn picture(&self) -> Option<String> {
        let samples = self.trace.samples();
        let last = samples.last()?;
        let drawn: Vec<Point> = self.drawn_path(|sample| sample.tool);
        let ghosts: Vec<Vec<Point>> = spaced(samples, GHOSTS)
            .map(|sample| self.arm_at(sample))
            .collect();
        let arm = self.arm_at(last);
        let range = BoundingBox::of(ghosts.iter().flatten().chain(&arm).chain(&drawn))?;

        let scale = (WIDTH - 2.0 * AIR) / range.width();
        let height = 2.0 * AIR + scale * range.height();
        let place = |[x, y]: Point| {
            [
                AIR + scale * (x - range.low[0]),
                height - AIR - scale * (y - range.low[1]),
            ]
        };
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.0}\" \
             role=\"img\" aria-label=\"The arm and its drawing\">\n\
             <style>{STYLE}</style>\n\
             <rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n"
        );
        let mut polyline = |class: &str, points: &[Point]| {
            let _ = write!(svg, "<polyline class=\"{class}\" points=\"");
            for &point in points {
                let [x, y] = place(point);
                let _ = write!(svg, "{x:.1},{y:.1} ");
            }
            svg.push_str("\"/>\n");
        };
        for ghost in &ghosts {
            polyline("ghost", ghost);
        }
        let drawn = thin(&drawn, WIDTH);
        let strokes = drawn.split(|point| !is_finite(point));
        for stroke in strokes.filter(|stroke| !stroke.is_empty()) {
            polyline("ink", stroke);
        }
        polyline("arm", &arm);
        for &joint in &arm {
            let [x, y] = place(joint);
            let _ = writeln!(
                svg,
                "<circle class=\"joint\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\"/>"
            );
        }
        svg.push_str("</svg>\n");
        Some(svg)
    }
}
