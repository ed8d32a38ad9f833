//! A log of a joint motion as a table.

use super::table::Table;
use fivebar_files::robot::DriveKind;

/// The columns that an identification reads of an arm with drives of this kind: of drives on a bus the torques that they are
/// told, of others the currents.
pub fn motion_columns(kind: DriveKind) -> [&'static str; 5] {
    let [first, fourth] = match kind {
        DriveKind::CanTorque => ["torque1_nm", "torque4_nm"],
        DriveKind::Brushed | DriveKind::Stepper | DriveKind::Servo => ["current1_a", "current4_a"],
    };
    ["time_s", "theta1_rad", "theta4_rad", first, fourth]
}

/// A table of these columns, of rows of time, θ1, θ4 and what drives 1 and 4 do.
pub fn motion_csv(columns: [&'static str; 5], rows: &[[f64; 5]]) -> String {
    let mut table = Table::new(columns);
    for &[time, others @ ..] in rows {
        let cells = others.iter().map(|value| format!("{value:.8}"));
        table.push(std::iter::once(format!("{time:.6}")).chain(cells));
    }
    table.into_text()
}
