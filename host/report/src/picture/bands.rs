//! The condition number of each cell in bands of colour.

use super::PAPER;
use super::axes::PictureFrame;
pub(super) use crate::html::BANDS;
use fivebar_design::workspace::{Cell, WorkspaceMap};
use std::fmt::Write as _;

/// Share of white in the colour of a cell that is not allowed.
const PALE: f64 = 0.62;

/// The band of a cell, and whether it is pale.
fn band(cell: &Cell) -> (usize, bool) {
    let band = (cell.inverse_condition * BANDS.len() as f64) as usize;
    (band.min(BANDS.len() - 1), !cell.clear)
}

/// A colour in the notation of SVG.
pub(super) fn colour(band: [u8; 3], pale: bool) -> String {
    let white = if pale { PALE } else { 0.0 };
    let [red, green, blue] = band.map(|part| {
        let part = f64::from(part);
        (part + white * (255.0 - part)).round() as u8
    });
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// The pattern of cells outside the joint limits.
pub(super) const HATCH: &str = "<defs><pattern id=\"hatch\" width=\"7\" height=\"7\" \
     patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\">\
     <path d=\"M0 0V7\" stroke=\"#5a6372\" stroke-width=\"1.6\"/></pattern></defs>\n";

/// All cells within reach.
pub(super) fn cells(map: &WorkspaceMap, frame: &PictureFrame) -> String {
    let [left, top] = frame.corner();
    let mut svg = format!(
        "{HATCH}<g transform=\"translate({left} {top})\" shape-rendering=\"crispEdges\">\n"
    );
    for (index, &rgb) in BANDS.iter().enumerate() {
        for pale in [false, true] {
            let path = runs(map, |cell| band(cell) == (index, pale));
            if !path.is_empty() {
                let _ = writeln!(svg, "<path fill=\"{}\" d=\"{path}\"/>", colour(rgb, pale));
            }
        }
    }
    let forbidden = runs(map, |cell| !cell.within_limits);
    if !forbidden.is_empty() {
        let _ = writeln!(svg, "<path fill=\"url(#hatch)\" d=\"{forbidden}\"/>");
    }
    svg.push_str("</g>\n");
    svg
}

/// A path around the selected cells: one rectangle for each run of them in a row.
fn runs(map: &WorkspaceMap, selected: impl Fn(&Cell) -> bool) -> String {
    let rows = map.grid().rows();
    let mut path = String::new();
    for (row, cells) in map.cells().chunks(map.grid().columns()).enumerate() {
        let from_top = rows - 1 - row;
        let mut column = 0;
        let is_selected = |cell: &Option<Cell>| cell.as_ref().is_some_and(&selected);
        for run in cells.chunk_by(|a, b| is_selected(a) == is_selected(b)) {
            let length = run.len();
            if run.first().is_some_and(is_selected) {
                let _ = write!(path, "M{column} {from_top}h{length}v1h-{length}z");
            }
            column += length;
        }
    }
    path
}

/// The legend's colour scale with its numbers.
pub(super) fn scale(left: f64, top: f64) -> String {
    const WIDTH: f64 = 24.0;
    const STEP: f64 = 17.0;
    let mut svg = String::new();
    for (index, &rgb) in BANDS.iter().rev().enumerate() {
        let y = top + STEP * index as f64;
        for (pale, x) in [(false, left), (true, left + WIDTH)] {
            let _ = write!(
                svg,
                "<rect x=\"{x}\" y=\"{y}\" width=\"{WIDTH}\" height=\"{STEP}\" fill=\"{}\"/>",
                colour(rgb, pale)
            );
        }
    }
    let height = STEP * BANDS.len() as f64;
    for tick in 0..=5 {
        let value = f64::from(tick) / 5.0;
        let y = top + height * (1.0 - value);
        let _ = write!(
            svg,
            "<path d=\"M{} {y}h5\" stroke=\"{}\"/><text x=\"{}\" y=\"{}\">{value:.1}</text>",
            left + 2.0 * WIDTH,
            super::INK,
            left + 2.0 * WIDTH + 9.0,
            y + 4.5,
        );
    }
    let _ = writeln!(
        svg,
        "<rect x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{height}\" fill=\"none\" stroke=\"{}\"/>\
         <path d=\"M{} {top}v{height}\" stroke=\"{PAPER}\"/>",
        2.0 * WIDTH,
        super::INK,
        left + WIDTH,
    );
    svg
}
