//! A log of a joint motion as a table.

use super::table::Table;

/// The columns that an identification reads, of rows of time, θ1, θ4, current 1 and current 4.
pub fn motion_csv(rows: &[[f64; 5]]) -> String {
    let mut table = Table::new([
        "time_s",
        "theta1_rad",
        "theta4_rad",
        "current1_a",
        "current4_a",
    ]);
    for &[time, angles_and_currents @ ..] in rows {
        let cells = angles_and_currents
            .iter()
            .map(|value| format!("{value:.8}"));
        table.push(std::iter::once(format!("{time:.6}")).chain(cells));
    }
    table.into_text()
}
