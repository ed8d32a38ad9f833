//! A figure over the workspace, in the colours of the workspace's picture, with axes.

use super::five_bar::Figure;
use crate::html::BANDS;
use fivebar_design::accuracy::five_bar::AccuracyMap;
use fivebar_design::workspace::SingularityCurve;
use fivebar_kinematics::five_bar::Singularity;
use std::fmt::Write as _;

/// Side of a cell [px].
const CELL: f64 = 8.0;
/// Room for the figures of the axes [px].
const LEFT: f64 = 46.0;
const BOTTOM: f64 = 30.0;
/// Steps between two figures of an axis [m].
const STEPS: [f64; 6] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5];
/// Least distance of two figures [px].
const APART: f64 = 60.0;

/// The figure of each cell: the least is yellow, the greatest violet, on a logarithmic scale. Singularity
/// curves of C lie above them.
pub(super) fn heat_map(
    map: &AccuracyMap,
    singularities: &[SingularityCurve],
    (name, figure): (&str, Figure),
    [least, greatest]: [f64; 2],
) -> String {
    let rows = map.cells.len() / map.columns;
    let span = (greatest / least).ln().max(1e-9);
    let (width, height) = (CELL * map.columns as f64, CELL * rows as f64);
    let mut svg = format!(
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{name} over the workspace\" \
         style=\"max-height:80vh\" font-size=\"12\" fill=\"currentColor\">",
        LEFT + width + 12.0,
        height + BOTTOM
    );
    let corner = map.cells.first().map(|cell| {
        let [x, y] = cell.position;
        [x - 0.5 * map.pitch, y - 0.5 * map.pitch]
    });
    for (index, cell) in map.cells.iter().enumerate() {
        let Some(analysis) = &cell.analysis else {
            continue;
        };
        let [column, row] = [index % map.columns, index / map.columns].map(|i| i as f64);
        let share = (figure(analysis) / least).ln() / span;
        let band = ((1.0 - share) * BANDS.len() as f64) as usize;
        let [red, green, blue] = BANDS[band.min(BANDS.len() - 1)];
        let (x, y) = (LEFT + CELL * column, height - CELL * (row + 1.0));
        let _ = write!(
            svg,
            "<rect x=\"{x}\" y=\"{y}\" width=\"8\" height=\"8\" \
             fill=\"#{red:02x}{green:02x}{blue:02x}\"/>"
        );
    }
    if let Some([left, low]) = corner {
        let scale = CELL / map.pitch;
        // What lies outside the map is cut off.
        let _ = write!(
            svg,
            "<svg x=\"{LEFT}\" y=\"0\" width=\"{width}\" height=\"{height}\" fill=\"none\" \
             stroke-width=\"1.5\">"
        );
        for curve in singularities {
            let mut path = String::from("M");
            for point in &curve.points {
                let (x, y) = (scale * (point.x - left), height - scale * (point.y - low));
                let _ = write!(path, "{x:.1} {y:.1} ");
            }
            let stroke = match curve.singularity {
                Singularity::Leg1 | Singularity::Leg4 => "stroke=\"currentColor\"",
                Singularity::Parallel => "stroke=\"#d81b60\" stroke-dasharray=\"7 4\"",
            };
            let _ = write!(svg, "<path d=\"{path}\" {stroke}/>");
        }
        svg.push_str("</svg>");
        let step = STEPS.into_iter().find(|step| step * scale >= APART);
        let step = step.unwrap_or(1.0);
        for (x, text) in figures(left, left + width / scale, step) {
            let at = LEFT + scale * (x - left);
            let _ = write!(
                svg,
                "<path d=\"M{at:.1} {height}v5\" stroke=\"currentColor\"/>\
                 <text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{text}</text>",
                height + 20.0
            );
        }
        for (y, text) in figures(low, low + height / scale, step) {
            let at = height - scale * (y - low);
            let _ = write!(
                svg,
                "<path d=\"M{LEFT} {at:.1}h-5\" stroke=\"currentColor\"/>\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
                LEFT - 8.0,
                at + 4.0
            );
        }
    }
    let _ = write!(
        svg,
        "<path d=\"M{LEFT} 0V{height}H{}\" fill=\"none\" stroke=\"currentColor\"/>",
        LEFT + width
    );
    svg + "</svg>"
}

/// The multiples of `step` between two positions [m], and their text [mm].
fn figures(from: f64, to: f64, step: f64) -> impl Iterator<Item = (f64, String)> {
    let (first, last) = ((from / step).ceil() as i32, (to / step).floor() as i32);
    (first..=last).map(move |index| {
        let at = f64::from(index) * step;
        (at, format!("{:.0}", 1e3 * at).replace('-', "−"))
    })
}
