//! A plate with holes at true size, to be printed or milled.

use nalgebra::Vector2;
use std::fmt::Write as _;

/// Free space around the holes [mm].
const EDGE: f64 = 15.0;

/// The plate as SVG: a unit is a millimetre. The holes [m] are numbered from 1; a bar of 100 mm
/// shows whether the printer keeps the size.
pub fn plate(holes: &[Vector2<f64>]) -> String {
    let bound = |pick: fn(f64, f64) -> f64, of: fn(&Vector2<f64>) -> f64| {
        holes.iter().map(of).map(|value| 1e3 * value).reduce(pick)
    };
    let x0 = bound(f64::min, |h| h.x).unwrap_or(0.0) - EDGE;
    let x1 = bound(f64::max, |h| h.x).unwrap_or(0.0) + EDGE;
    let y0 = bound(f64::min, |h| h.y).unwrap_or(0.0) - EDGE;
    let y1 = bound(f64::max, |h| h.y).unwrap_or(0.0) + EDGE;
    let (width, height) = ((x1 - x0).max(100.0 + 2.0 * EDGE), y1 - y0 + EDGE);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.3}mm\" height=\"{height:.3}mm\" \
         viewBox=\"0 0 {width:.3} {height:.3}\" fill=\"none\" stroke=\"black\" \
         stroke-width=\"0.1\" font-size=\"3\" font-family=\"sans-serif\">\n\
         <title>Holes for the calibration, at true size; y is up</title>\n\
         <rect x=\"0.05\" y=\"0.05\" width=\"{:.3}\" height=\"{:.3}\"/>\n",
        width - 0.1,
        height - 0.1
    );
    for (index, hole) in holes.iter().enumerate() {
        let (x, y) = (1e3 * hole.x - x0, y1 - 1e3 * hole.y);
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.3}\" cy=\"{y:.3}\" r=\"1\"/>\
             <path d=\"M{:.3} {y:.3}h4M{x:.3} {:.3}v4\"/>\
             <text x=\"{:.3}\" y=\"{:.3}\" fill=\"black\" stroke=\"none\">{}</text>",
            x - 2.0,
            y - 2.0,
            x + 1.5,
            y - 1.5,
            index + 1
        );
    }
    let bar = height - 0.7 * EDGE;
    let _ = writeln!(
        svg,
        "<path d=\"M{EDGE} {:.3}v4m0 -2h100m0 -2v4\"/>\
         <text x=\"{EDGE}\" y=\"{:.3}\" fill=\"black\" stroke=\"none\">100 mm</text>\n</svg>",
        bar - 2.0,
        bar + 6.0
    );
    svg
}

#[cfg(test)]
mod tests {
    use super::plate;
    use nalgebra::Vector2;

    #[test]
    fn holes_lie_at_true_size_with_y_up() {
        let svg = plate(&[Vector2::new(0.0, 0.0), Vector2::new(0.2, 0.05)]);
        assert!(
            svg.contains("width=\"230.000mm\" height=\"95.000mm\""),
            "{svg}"
        );
        assert!(svg.contains("cx=\"15.000\" cy=\"65.000\""), "{svg}");
        assert!(svg.contains("cx=\"215.000\" cy=\"15.000\""), "{svg}");
    }
}
