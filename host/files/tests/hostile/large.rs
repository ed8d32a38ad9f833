//! Large files as people have them: each is read, so that no reader is quick because it refuses all.

use crate::svg::page;
use crate::tables::{png, zeros};
use crate::{Input, Kind, counted, drawings, kind, pictures};
use std::f64::consts::TAU;

/// The parts of a file, each by its number.
fn parts(count: usize, part: impl Fn(usize) -> String) -> String {
    (0..count).map(part).collect()
}

/// Files, and how many steps, rows or others of its kind a file has at least.
#[expect(clippy::too_many_lines, reason = "a list of files")]
pub(crate) fn kinds() -> Vec<(Kind, usize)> {
    let mut kinds: Vec<(Kind, usize)> = Vec::new();
    let lines = counted(200_000);
    let gcode = move || {
        let line = |n: usize| format!("G1 X{}.{:03} Y{}\n", n % 60, n % 1000, n % 2);
        format!("G21 G90 F600\n{}", parts(lines, line))
    };
    kinds.push((kind("large: lines in G-code", gcode), lines));
    let arcs = counted(60_000);
    let gcode = move || {
        let halves = "G2 X9 Y0 I4.5 J0\nG3 X0 Y0 I-4.5 J0\n";
        format!("G21 G90 F600\nG0 X0 Y0\n{}", halves.repeat(arcs / 2))
    };
    kinds.push((kind("large: arcs in G-code", gcode), arcs));
    // Curves around a circle; in units of a thousandth of a pixel, and with lines as wide as the drawing.
    let curves = counted(20_000);
    let curve = move |n: usize| {
        let (sin, cos) = (TAU * n as f64 / curves as f64).sin_cos();
        let [x, y] = [1e5 + 7e4 * cos, 6e4 + 5e4 * sin];
        format!("<path d=\"M{x:.0} {y:.0}q100 400 0 800\"/>")
    };
    for (name, style) in [
        ("curves", "stroke-width:9"),
        ("wide curves", "stroke-width:1e5"),
    ] {
        let drawing = move || {
            let group = format!(
                "<g fill=\"none\" stroke=\"red\" transform=\"scale(1e-3)\" style=\"{style}\">"
            );
            page(&format!("{group}{}</g>", parts(curves, curve)))
        };
        kinds.push((kind(format!("large: {name} in SVG"), drawing), 2 * curves));
    }
    let arrows = counted(5_000);
    let drawing = move || {
        let marker = "<marker id=\"m\" orient=\"auto\"><path d=\"M0 0Q2 1 0 2\"/></marker>";
        let line = |n: usize| {
            let y = n as f64 * 200.0 / arrows as f64;
            format!(
                "<path d=\"M9 {y}Q20 9 200 {y}\" stroke=\"red\" fill=\"none\" marker-end=\"url(#m)\"/>"
            )
        };
        page(&format!("{marker}{}", parts(arrows, line)))
    };
    kinds.push((kind("large: arrows in SVG", drawing), 4 * arrows));
    let lines = counted(50_000);
    let dxf = move || {
        let line = |n: usize| format!("0 LINE|8 0|10 {}|20 {}|11 9|21 9|", n % 60, n % 7);
        drawings::file("", &parts(lines, line))
    };
    kinds.push((kind("large: lines in DXF", dxf), lines));
    let side = if counted(10) == 1 { 32 } else { 100 };
    let dxf = move || {
        let insert = format!("0 INSERT|2 b|10 0|20 0|70 {side}|71 {side}|44 0.5|45 0.5");
        drawings::file(
            "0 BLOCK|2 b|0 CIRCLE|8 0|10 0|20 0|40 0.2|0 ENDBLK|",
            &insert,
        )
    };
    kinds.push((
        kind("large: copies of a block in DXF", dxf),
        8 * side * side,
    ));
    let lines = counted(100_000);
    let plot = move || {
        format!(
            "IN;SP1;{}",
            "PU0,0;PD900,0;PU900,9;PD0,9;".repeat(lines / 2)
        )
    };
    kinds.push((kind("large: lines in HPGL", plot), lines));
    let rows = counted(1_000_000);
    let table = move || Input::Stream("a,y,b,x\n".into(), "1.5,2,-7,1e-3\n".into(), rows);
    kinds.push((("large: rows of a table".into(), Box::new(table)), rows));
    let height = counted(6_000);
    let picture = move || {
        Input::Picture(png(
            [1_000, height as u32],
            &zeros(height * (8 * 1_000 + 1)),
        ))
    };
    kinds.push((("large: a PNG".into(), Box::new(picture)), 6_000_000));
    let robot = || Input::Robot(include_str!("../../robots/benchtop.toml").into());
    kinds.extend(pictures::photographs());
    kinds.push((("large: a robot".into(), Box::new(robot)), 1));
    kinds
}
