//! The errors of a photographed drawing as a table.

use super::table::Table;
use crate::study::photo::PhotoStudy;

/// A row for each point that was measured: its line in the job, the point, the direction across the
/// stroke, and the error in this direction.
pub fn photo_csv(study: &PhotoStudy) -> String {
    let mut table = Table::new(["line", "x_m", "y_m", "normal_x", "normal_y", "error_m"]);
    for deviation in &study.comparison.deviations {
        table.push([
            study
                .strokes
                .line(deviation.stroke, deviation.piece)
                .to_string(),
            format!("{:.6}", deviation.place.x),
            format!("{:.6}", deviation.place.y),
            format!("{:.4}", deviation.normal.x),
            format!("{:.4}", deviation.normal.y),
            format!("{:.7}", deviation.error),
        ]);
    }
    table.into_text()
}

/// The points of a drawing for `calibrate --photo`.
pub fn photo_points_csv(rows: &[[f64; 4]]) -> String {
    let mut table = Table::new(["counts1", "counts4", "u", "v"]);
    for [counts1, counts4, u, v] in rows {
        table.push([
            format!("{counts1:.1}"),
            format!("{counts4:.1}"),
            format!("{u:.3}"),
            format!("{v:.3}"),
        ]);
    }
    table.into_text()
}
