//! The validation drawing before and after a commissioning, its errors magnified.

use super::{INK, PAPER};
use std::fmt::Write as _;

/// A point of a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnPoint {
    /// Where the tip should be [m].
    pub wanted: [f64; 2],
    /// How far it is from there [m].
    pub error: [f64; 2],
}

/// Width of the picture, and the space around the drawing.
const WIDTH: f64 = 800.0;
const EDGE: f64 = 60.0;
/// The greatest error as a share of the drawing's width.
const SHOWN: f64 = 0.04;
/// Colours of the drawings before and after.
const COLOURS: [&str; 2] = ["#d81b60", "#1e88e5"];

/// The wanted path and the drawings before and after as SVG; all errors are magnified alike. None
/// without points.
pub fn validation(drawings: [&[DrawnPoint]; 2]) -> Option<String> {
    let points = || drawings.into_iter().flatten();
    let bound = |axis: usize, pick: fn(f64, f64) -> f64| {
        points().map(|point| point.wanted[axis]).reduce(pick)
    };
    let [x0, y0] = [bound(0, f64::min)?, bound(1, f64::min)?];
    let [x1, y1] = [bound(0, f64::max)?, bound(1, f64::max)?];
    let width = (x1 - x0).max(y1 - y0).max(1e-6);
    let scale = (WIDTH - 2.0 * EDGE) / width;
    let size = |point: &DrawnPoint| point.error[0].hypot(point.error[1]);
    let greatest = points().map(size).fold(1e-9, f64::max);
    let factor = round_down(SHOWN * width / greatest);
    let height = scale * (y1 - y0) + 2.0 * EDGE;
    let place = |[x, y]: [f64; 2]| [EDGE + scale * (x - x0), EDGE + scale * (y1 - y)];
    let line = |drawing: &[DrawnPoint], factor: f64| {
        let mut line = String::new();
        for DrawnPoint { wanted, error } in drawing {
            let [x, y] = place([0, 1].map(|axis| wanted[axis] + factor * error[axis]));
            let _ = write!(line, "{x:.1},{y:.1} ");
        }
        line
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH:.0} {height:.0}\" \
         fill=\"none\" font-family=\"sans-serif\" font-size=\"14\">\n\
         <title>The validation drawing before and after commissioning</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"{PAPER}\"/>\n\
         <polyline stroke=\"{INK}\" stroke-width=\"0.5\" points=\"{}\"/>\n",
        line(drawings[1], 0.0)
    );
    for ((drawing, colour), when) in drawings.into_iter().zip(COLOURS).zip(["before", "after"]) {
        let squares: f64 = drawing.iter().map(|point| size(point).powi(2)).sum();
        let rms = 1e6 * (squares / drawing.len().max(1) as f64).sqrt();
        let y = if when == "before" { 24.0 } else { 44.0 };
        let _ = writeln!(
            svg,
            "<polyline stroke=\"{colour}\" points=\"{}\"/>\n\
             <text x=\"{EDGE}\" y=\"{y}\" fill=\"{colour}\">{when}: {rms:.1} µm RMS, error shown \
             {factor:.0} times</text>",
            line(drawing, factor)
        );
    }
    Some(svg + "</svg>\n")
}

/// The greatest of 1, 2 and 5 times a power of ten that is not above `value`; 1 at least.
pub(super) fn round_down(value: f64) -> f64 {
    let power = 10_f64.powf(value.max(1.0).log10().floor());
    let share = [5.0, 2.0].into_iter().find(|share| share * power <= value);
    share.unwrap_or(1.0) * power
}

#[cfg(test)]
mod tests {
    use super::{DrawnPoint, round_down, validation};

    #[test]
    fn errors_are_magnified_alike_and_stated() {
        let drawing = |error: f64| {
            [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1]].map(|wanted| DrawnPoint {
                wanted,
                error: [0.0, error],
            })
        };
        let svg = validation([&drawing(80e-6), &drawing(20e-6)]).unwrap();
        assert!(
            svg.contains("before: 80.0 µm RMS, error shown 50 times"),
            "{svg}"
        );
        assert!(svg.contains("after: 20.0 µm RMS, error shown 50 times"));
        // 80 µm, 50 times, of 100 mm are 4 % of the width of 680.
        assert!(svg.contains("740.0,712.8 "), "{svg}");
        assert!(validation([&[], &[]]).is_none());
    }

    #[test]
    fn factors_are_round() {
        assert_eq!(
            [0.3, 1.0, 4.9, 50.0, 199.0].map(round_down),
            [1.0, 1.0, 2.0, 50.0, 100.0]
        );
    }
}
