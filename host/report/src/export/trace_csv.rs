//! A trace as a table: a row for each sample; the columns' names contain the units.

use fivebar_sim::simulation::{Sample, Trace};
use std::fmt::Write as _;

const HEADER: [&str; 24] = [
    "time_s",
    "line",
    "reference_x_m",
    "reference_y_m",
    "tool_x_m",
    "tool_y_m",
    "theta1_rad",
    "theta4_rad",
    "reference_theta1_rad",
    "reference_theta4_rad",
    "reference_omega1_rad_s",
    "reference_omega4_rad_s",
    "reference_alpha1_rad_s2",
    "reference_alpha4_rad_s2",
    "torque1_nm",
    "torque4_nm",
    "current_set_point1_a",
    "current_set_point4_a",
    "current1_a",
    "current4_a",
    "duty1",
    "duty4",
    "saturated",
    "tool_level",
];

/// The samples as comma-separated values with a header line. No cell needs quotes, and a trace has some millions: a writer
/// that looks for what needs them takes as long as the run itself.
pub fn trace_csv(trace: &Trace) -> String {
    let mut text = HEADER.join(",") + "\n";
    for sample in trace.samples() {
        // Writing into a string cannot fail.
        let _ = write!(text, "{:.7},{}", sample.time, sample.line);
        for [first, second] in pairs(sample) {
            let _ = write!(text, ",{first:.9},{second:.9}");
        }
        let (saturated, level) = (u8::from(sample.saturated), sample.tool_level);
        let _ = writeln!(text, ",{saturated},{level:.5}");
    }
    text
}

/// The columns that exist for both drives, in the order of the header.
fn pairs(sample: &Sample) -> [[f64; 2]; 10] {
    [
        sample.reference,
        sample.tool,
        sample.angle,
        sample.reference_angle,
        sample.reference_velocity,
        sample.reference_acceleration,
        sample.torque,
        sample.current_set_point,
        sample.current,
        sample.duty,
    ]
}

#[cfg(test)]
mod tests {
    use super::trace_csv;
    use fivebar_sim::simulation::{Sample, Trace};

    #[test]
    fn has_a_name_for_every_column_and_a_row_for_every_sample() {
        let mut trace = Trace::default();
        for tick in 0..3 {
            trace.push(Sample {
                time: f64::from(tick) * 1e-4,
                duty: [0.25, -0.5],
                saturated: true,
                tool_level: 0.5,
                ..Sample::default()
            });
        }
        let csv = trace_csv(&trace);
        let columns: Vec<usize> = csv.lines().map(|line| line.split(',').count()).collect();
        assert_eq!(columns, [24; 4]);
        let last = csv.lines().last().unwrap();
        assert!(
            last.starts_with("0.0002000,0,")
                && last.ends_with("0.250000000,-0.500000000,1,0.50000")
        );
    }
}
