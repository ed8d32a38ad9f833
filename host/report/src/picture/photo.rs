//! The errors of a photographed drawing: its strokes, moved aside by their errors, in the colours of these.

use super::bands::{BANDS, colour};
use super::tip_error::{band, scale};
use super::validation::round_down;
use super::{INK, PAPER, cross};
use crate::study::photo::PhotoStudy;
use crate::text::quantity;
use fivebar_design::photo::Deviation;
use nalgebra::Vector2;
use quick_xml::escape::escape;
use std::fmt::Write as _;

/// The longer side of the drawing, the space around it, above it and right of it for the scale.
const SIDE: f64 = 680.0;
const EDGE: f64 = 40.0;
const TITLE: f64 = 70.0;
const LEGEND: f64 = 220.0;
/// Least height of the scale.
const SCALE_HEIGHT: f64 = 280.0;
/// The greatest error as a share of the longer side.
const SHOWN: f64 = 0.03;
/// Points of a stroke that are farther apart [m] are not joined: between them nothing was measured.
const GAP: f64 = 1.2e-3;
/// Length of the bar below the drawing [m].
const BAR: f64 = 0.02;

/// The map as SVG.
pub fn drawing_errors(name: &str, study: &PhotoStudy) -> String {
    let found = &study.comparison;
    let points = || study.strokes.points.iter().flatten();
    let low = points()
        .copied()
        .reduce(|a, b| a.inf(&b))
        .unwrap_or_default();
    let high = points()
        .copied()
        .reduce(|a, b| a.sup(&b))
        .unwrap_or_default();
    let longer = (high - low).max().max(1e-6);
    let zoom = SIDE / longer;
    let size = (high - low) * zoom;
    let place = |q: Vector2<f64>| {
        let at = (q - low) * zoom;
        [EDGE + at.x, TITLE + EDGE + size.y - at.y]
    };
    let legend = EDGE + size.x + EDGE;
    let [width, height] = [
        legend + LEGEND,
        TITLE + (size.y + 2.0 * EDGE).max(SCALE_HEIGHT) + EDGE,
    ];
    let greatest = found.greatest();
    let worst = greatest.map_or(0.0, |greatest| greatest.error.abs());
    let factor = round_down(SHOWN * longer / worst.max(1e-9));
    let title = format!("Errors of {}", escape(name));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" \
         font-family=\"DejaVu Sans, sans-serif\" font-size=\"13\" fill=\"{INK}\">\n\
         <title>{title}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"{PAPER}\"/>\n\
         <text x=\"{EDGE}\" y=\"32\" font-size=\"18\">{title}</text>\n\
         <text x=\"{EDGE}\" y=\"53\">{} RMS, {} at the cross; shown {factor:.0} times, across the \
         strokes</text>\n<g fill=\"none\" stroke-width=\"0.6\" stroke=\"{INK}\">\n",
        quantity(found.rms, "m"),
        quantity(worst, "m"),
    );
    for stroke in &study.strokes.points {
        let _ = writeln!(
            svg,
            "<path d=\"{}\"/>",
            path(stroke.iter().map(|&q| place(q)))
        );
    }
    svg.push_str("</g>\n<g fill=\"none\" stroke-width=\"2\" stroke-linejoin=\"round\">\n");
    let is_near =
        |a: &Deviation, b: &Deviation| a.stroke == b.stroke && (a.place - b.place).norm() < GAP;
    let colour_of = |d: &Deviation| band(d.error.abs(), worst);
    let mut rest = &found.deviations[..];
    while let Some(first) = rest.first() {
        let pairs = rest.windows(2);
        let same =
            pairs.take_while(|d| is_near(&d[0], &d[1]) && colour_of(first) == colour_of(&d[1]));
        let count = 1 + same.count();
        // Where only the colour changes, the line goes on.
        let goes_on = rest
            .get(count)
            .is_some_and(|next| is_near(&rest[count - 1], next));
        let run = &rest[..count + usize::from(goes_on)];
        let moved = run
            .iter()
            .map(|d| place(d.place + d.normal * (factor * d.error)));
        let line = colour(BANDS[colour_of(first)], false);
        let _ = writeln!(svg, "<path stroke=\"{line}\" d=\"{}\"/>", path(moved));
        rest = &rest[count..];
    }
    svg.push_str("</g>\n");
    if let Some(greatest) = greatest {
        let [x, y] = place(greatest.place);
        svg.push_str(&cross(x, y));
    }
    svg.push_str(&scale(worst, [legend, TITLE + EDGE]));
    let bar = TITLE + 2.0 * EDGE + size.y - 12.0;
    let _ = writeln!(
        svg,
        "<path d=\"M{EDGE} {bar:.1}v8m0 -4h{:.1}m0 -4v8\" fill=\"none\" stroke=\"{INK}\"/>\
         <text x=\"{EDGE}\" y=\"{:.1}\">{}</text>\n</svg>",
        BAR * zoom,
        bar + 24.0,
        quantity(BAR, "m"),
    );
    svg
}

/// A line through points of the picture; a single point is a dot.
fn path(points: impl Iterator<Item = [f64; 2]>) -> String {
    let mut path = String::new();
    for [x, y] in points {
        let letter = if path.is_empty() { 'M' } else { 'L' };
        let _ = write!(path, "{letter}{x:.1} {y:.1}");
    }
    path + "h0.1"
}
