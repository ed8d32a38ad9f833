//! The error of the tip over the workspace, before and after a calibration.

use super::axes::PictureFrame;
use super::bands::{BANDS, colour};
use super::{INK, PAPER};
use crate::study::workspace::WorkspaceStudyError;
use crate::text::quantity;
use fivebar_design::calibration::TipError;
use fivebar_kinematics::five_bar::Tool;
use quick_xml::escape::escape;
use std::fmt::Write as _;

/// Both maps as SVG, one above the other, each with its own scale: the error of the arm in its file, as
/// found, and that expected with the measured values.
///
/// # Errors
/// The arm's reach cannot be drawn.
pub fn tip_errors(
    name: &str,
    tool: &Tool<f64>,
    before: &TipError,
    after: &TipError,
) -> Result<String, WorkspaceStudyError> {
    let maps = [
        ("before: found, at the best placement", before),
        ("after: expected", after),
    ];
    let frame = PictureFrame::around(tool)?;
    let [width, height] = frame.picture_size();
    let title = format!("Error of the tip of {}", escape(name));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {}\" \
         font-family=\"DejaVu Sans, sans-serif\" font-size=\"13\" fill=\"{INK}\">\n\
         <title>{title}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"{PAPER}\"/>\n",
        2.0 * height
    );
    for (index, (when, map)) in maps.into_iter().enumerate() {
        let _ = writeln!(
            svg,
            "<g transform=\"translate(0 {})\">\n\
             <text x=\"{}\" y=\"32\" font-size=\"18\">{title}, {when}</text>\n\
             <text x=\"{}\" y=\"53\">{} RMS, {} at the worst place</text>\n{}{}{}</g>",
            height * index as f64,
            frame.left(),
            frame.left(),
            quantity(map.rms, "m"),
            quantity(map.worst, "m"),
            frame.axes(),
            places(map, &frame),
            scale(map.worst, [frame.legend_left(), frame.top()]),
        );
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

/// The band of an error: bright is small.
pub(super) fn band(error: f64, worst: f64) -> usize {
    let share = 1.0 - error / worst.max(f64::MIN_POSITIVE);
    ((share * BANDS.len() as f64) as usize).min(BANDS.len() - 1)
}

/// A square at each place, as wide as the places are apart.
fn places(map: &TipError, frame: &PictureFrame) -> String {
    let apart = map
        .points
        .windows(2)
        .map(|pair| (pair[1].0 - pair[0].0).norm());
    let pitch = apart.fold(f64::INFINITY, f64::min);
    let mut svg = String::from("<g shape-rendering=\"crispEdges\">\n");
    for (place, error) in &map.points {
        let half = nalgebra::Vector2::repeat(0.5 * pitch);
        let ([x0, y1], [x1, y0]) = (
            frame.to_picture(place - half),
            frame.to_picture(place + half),
        );
        let _ = writeln!(
            svg,
            "<rect x=\"{x0:.1}\" y=\"{y0:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{}\">\
             <title>{}</title></rect>",
            x1 - x0,
            y1 - y0,
            colour(BANDS[band(*error, map.worst)], false),
            quantity(*error, "m"),
        );
    }
    svg + "</g>\n"
}

/// The colours with the greatest error of each.
pub(super) fn scale(worst: f64, [left, top]: [f64; 2]) -> String {
    let mut svg = String::new();
    for (index, &rgb) in BANDS.iter().enumerate() {
        let y = top + 22.0 * index as f64;
        let most = worst * (1.0 - index as f64 / BANDS.len() as f64);
        let _ = writeln!(
            svg,
            "<rect x=\"{left}\" y=\"{y}\" width=\"44\" height=\"22\" fill=\"{}\"/>\
             <text x=\"{}\" y=\"{}\">up to {}</text>",
            colour(rgb, false),
            left + 56.0,
            y + 15.5,
            quantity(most, "m"),
        );
    }
    svg
}

#[cfg(test)]
mod tests {
    use super::tip_errors;
    use fivebar_design::calibration::TipError;
    use fivebar_kinematics::five_bar::{Geometry, Tool};
    use nalgebra::Vector2;

    #[test]
    fn each_map_has_its_places_in_the_colours_of_its_own_scale() {
        let geometry = Geometry::new([0.10, 0.16, 0.16, 0.10, 0.08]).unwrap();
        let tool = Tool::new(geometry, Vector2::zeros()).unwrap();
        let map = |size: f64| TipError {
            points: vec![
                (Vector2::new(0.02, 0.2), size),
                (Vector2::new(0.03, 0.2), 0.1 * size),
            ],
            rms: 0.7 * size,
            worst: size,
        };
        let svg = tip_errors("a<b", &tool, &map(1e-3), &map(2e-5)).unwrap();
        for wanted in [
            "Error of the tip of a&lt;b, before",
            "700 µm RMS, 1.00 mm at the worst place",
            "fill=\"#440154\"><title>1.00 mm</title>",
            "fill=\"#fde725\"><title>100 µm</title>",
            "fill=\"#440154\"><title>20.0 µm</title>",
            "up to 18.0 µm",
        ] {
            assert!(svg.contains(wanted), "{wanted} in {svg}");
        }
    }
}
