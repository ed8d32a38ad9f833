//! The places of a study as a table.

use crate::study::workspace::Study;
use fivebar_design::workspace::Cell;
use std::fmt::Write as _;

/// The columns: sines and the condition number have no unit, flags are 0 or 1.
const HEADER: &str = "x_m,y_m,elbow1,elbow4,assembly,within_limits,clear,\
                      abs_sin_leg1,abs_sin_leg4,abs_sin_parallel,condition_number\n";

/// A line for every place in every working mode that reaches it.
pub fn workspace_csv(study: &Study<'_>) -> String {
    let mut csv = String::from(HEADER);
    // To a micrometre; of smaller cells to a thousandth.
    let decimals = (3.0 - study.resolution().log10().floor()).max(6.0) as usize;
    for map in &study.maps {
        let mode = map.workspace().mode;
        for (place, cell) in map.reached() {
            let Cell {
                assembly,
                elbow_sines: [sine1, sine4],
                sin32,
                inverse_condition,
                within_limits,
                clear,
            } = cell;
            let [within_limits, clear] = [within_limits, clear].map(|&flag| u8::from(flag));
            let _ = writeln!(
                csv,
                "{:.decimals$},{:.decimals$},{},{},{assembly},{within_limits},{clear},{:.4},{:.4},{:.4},{:.4e}",
                place.x,
                place.y,
                mode.elbow1,
                mode.elbow4,
                sine1.abs(),
                sine4.abs(),
                sin32.abs(),
                1.0 / inverse_condition,
            );
        }
    }
    csv
}
