//! A photographed drawing as text.

use super::quantity;
use crate::study::photo::PhotoStudy;
use std::fmt::Write as _;

/// The figures of a photographed drawing. `measured`: the marks were measured;
/// `lens_known`: so was the lens.
pub fn photo(study: &PhotoStudy, measured: bool, lens_known: bool) -> String {
    let found = &study.comparison;
    let metres = |length: f64| quantity(length, "m");
    let mut text = format!("error across the strokes: {} RMS", metres(found.rms));
    if let Some((line, error, place)) = study.greatest() {
        let _ = write!(
            text,
            ", {} at most, at ({:.1}, {:.1}) mm, {} {line} of the job",
            metres(error.abs()),
            1e3 * place.x,
            1e3 * place.y,
            study.strokes.unit()
        );
    }
    let _ = writeln!(
        text,
        "\n  measured: {} of {} of strokes; the rest is near other strokes or without ink",
        metres(found.measured),
        metres(found.drawn)
    );
    let _ = writeln!(text, "  a pixel shows {} of the paper", metres(found.pixel));
    let _ = writeln!(
        text,
        "  lens: k = {:.4}, {} at most over the drawing{}",
        found.lens,
        metres(found.lens_shift),
        match lens_known {
            true => "",
            false => "; what errors of the arm have in common with it is not in the map",
        }
    );
    let _ = writeln!(
        text,
        "  {}",
        match measured {
            true =>
                "the marks were measured: only the placement of the drawing on the paper is not in the map",
            false =>
                "the arm drew the marks: placement, turn, scales, shear and perspective are not in the \
                 map; measure the marks' distances for these (--distances)",
        }
    );
    if let Some(scales) = &found.scales {
        let ([x, y], [x_sd, y_sd]) = (scales.factors, scales.deviations);
        let _ = writeln!(
            text,
            "  scales of the drawing: {x:.5} in x, {y:.5} in y (deviations {x_sd:.5}, {y_sd:.5}, and the share by which the \
             marks' distances are off); --corrected writes the job that takes them away"
        );
    }
    text
}
