//! The arms of a synthesis, each with its work area, side by side at one scale.

use super::{INK, PAPER};
use fivebar_design::synthesis::{Area, Design};
use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
use nalgebra::Vector2;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Side of an arm's cell, the space at its edge, and the line for its name.
const CELL: f64 = 210.0;
const EDGE: f64 = 12.0;
const NAME: f64 = 22.0;
/// Most cells in a row.
const COLUMNS: usize = 4;
/// Chords of a full circle.
const CHORDS: u32 = 90;
const AREA: &str = "#3b6ea8";

/// The drawing, and what it is for each arm. The tool is in the middle of the area.
pub(crate) fn designs(arms: &[(String, Design)], area: &Area) -> String {
    let drawn: Vec<_> = arms
        .iter()
        .map(|(name, design)| (name, arm(design, area), outline(design, area)))
        .collect();
    let extent = |(_, arm, outline): &(&String, Vec<_>, Vec<Vec<_>>)| {
        let points = || arm.iter().chain(outline.iter().flatten());
        let low = points().copied().reduce(|a: Vector2<f64>, b| a.inf(&b));
        let high = points().copied().reduce(|a: Vector2<f64>, b| a.sup(&b));
        [low.unwrap_or_default(), high.unwrap_or_default()]
    };
    let longest = drawn
        .iter()
        .map(|drawn| {
            let [low, high] = extent(drawn);
            (high - low).max()
        })
        .fold(1e-6, f64::max);
    let zoom = (CELL - 2.0 * EDGE) / longest;
    let columns = arms.len().clamp(1, COLUMNS);
    let rows = arms.len().div_ceil(columns);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0} {:.0}\" \
         font-family=\"DejaVu Sans, sans-serif\" font-size=\"13\" fill=\"{INK}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"{PAPER}\"/>\n",
        columns as f64 * CELL,
        rows as f64 * (CELL + NAME),
    );
    for (index, drawn) in drawn.iter().enumerate() {
        let (name, arm, outline) = drawn;
        let [low, high] = extent(drawn);
        let middle = (low + high) * 0.5;
        let left = (index % columns) as f64 * CELL;
        let top = (index / columns) as f64 * (CELL + NAME);
        let place = |p: &Vector2<f64>| {
            let at = (p - middle) * zoom;
            let [x, y] = [left + 0.5 * CELL + at.x, top + NAME + 0.5 * CELL - at.y];
            format!("{x:.1},{y:.1}")
        };
        let line = |points: &[Vector2<f64>]| points.iter().map(place).collect::<Vec<_>>().join(" ");
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\">{name}</text>",
            left + EDGE,
            top + 16.0
        );
        for path in outline {
            let _ = writeln!(
                svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{AREA}\" stroke-width=\"1.5\"/>",
                line(path)
            );
        }
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"3\" \
             stroke-linejoin=\"round\" stroke-linecap=\"round\"/>",
            line(arm)
        );
        for joint in arm {
            let at = place(joint);
            let (x, y) = at.split_once(',').unwrap_or_default();
            let _ = writeln!(
                svg,
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"3.5\" fill=\"{PAPER}\" stroke=\"{INK}\" stroke-width=\"1.5\"/>"
            );
        }
    }
    svg.push_str("</svg>");
    svg
}

/// A, B, C, D and E from the middle of the base, with C in the middle of the area.
fn arm(design: &Design, area: &Area) -> Vec<Vector2<f64>> {
    let half = Vector2::new(0.5 * design.lengths[4], 0.0);
    let outwards = WorkingMode::new(Side::Right, Side::Left);
    let [x, y] = design.place;
    let c = match area {
        Area::Annulus => Vector2::new(0.0, y + 0.5 * design.size),
        Area::Rectangle { aspect } => Vector2::new(x, y + 0.5 * design.size / aspect),
        _ => outline(design, area)
            .first()
            .and_then(|path| path.first())
            .copied()
            .unwrap_or_default(),
    };
    let pose = Geometry::new(design.lengths)
        .ok()
        .and_then(|geometry| geometry.inverse(c + half, outwards).ok());
    pose.map_or(Vec::new(), |pose| {
        vec![-half, pose.b - half, pose.c - half, pose.d - half, half]
    })
}

/// The lines around the area, or its paths, from the middle of the base.
fn outline(design: &Design, area: &Area) -> Vec<Vec<Vector2<f64>>> {
    let (size, [x, y]) = (design.size, design.place);
    match area {
        Area::Annulus => [y, y + size]
            .map(|radius| {
                let angles = (0..=CHORDS).map(|i| TAU * f64::from(i) / f64::from(CHORDS));
                angles
                    .map(|angle| Vector2::new(radius * angle.cos(), radius * angle.sin()))
                    .collect()
            })
            .to_vec(),
        Area::Rectangle { aspect } => {
            let (half, top) = (0.5 * size, y + size / aspect);
            let corners = [[-half, y], [half, y], [half, top], [-half, top], [-half, y]];
            vec![corners.map(|[dx, y]| Vector2::new(x + dx, y)).to_vec()]
        }
        Area::Paths(paths) => paths
            .iter()
            .map(|path| {
                path.iter()
                    .map(|p| Vector2::new(x + size * p[0], y + size * p[1]))
                    .collect()
            })
            .collect(),
        _ => Vec::new(),
    }
}
