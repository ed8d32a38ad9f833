//! The cells of a workspace study as a table.

use super::table::Table;
use crate::study::workspace::WorkspaceStudy;

/// The columns. Sines and the condition number are dimensionless; flags are 0 or 1.
const HEADER: [&str; 11] = [
    "x_m",
    "y_m",
    "elbow1",
    "elbow4",
    "assembly",
    "within_limits",
    "clear",
    "abs_sin_leg1",
    "abs_sin_leg4",
    "abs_sin_parallel",
    "condition_number",
];

/// A row for each cell and each working mode that reaches it.
pub fn workspace_csv(study: &WorkspaceStudy<'_>) -> String {
    let mut table = Table::new(HEADER);
    // Positions to 1 µm, or to a thousandth of a cell if that is less.
    let decimals = (3.0 - study.resolution().log10().floor()).max(6.0) as usize;
    let flag = |flag: bool| u8::from(flag).to_string();
    let sine = |sine: f64| format!("{:.4}", sine.abs());
    for map in &study.maps {
        let mode = map.workspace().mode;
        for (place, cell) in map.reached() {
            let [sine1, sine4] = cell.elbow_sines;
            table.push([
                format!("{:.decimals$}", place.x),
                format!("{:.decimals$}", place.y),
                mode.elbow1.to_string(),
                mode.elbow4.to_string(),
                cell.assembly.to_string(),
                flag(cell.within_limits),
                flag(cell.clear),
                sine(sine1),
                sine(sine4),
                sine(cell.sin32),
                format!("{:.4e}", 1.0 / cell.inverse_condition),
            ]);
        }
    }
    table.into_text()
}
