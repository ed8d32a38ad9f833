//! The loads of a run: torques by cause, currents, duties.

use super::shares::ShareModel;
use super::{RunReport, spaced};
use crate::html::{Chart, Page, Point};
use crate::text::quantity;
use fivebar_kinematics::dynamics::{ShareTotals, TorqueComponents};
use fivebar_sim::machine::Signal;
use fivebar_sim::simulation::Sample;

/// Samples for the causes of the torques.
const SHARE_SAMPLES: usize = 4_000;
/// The parts of a torque, in the order of [`TorqueComponents::parts`].
const CAUSES: [&str; 5] = [
    "inertia",
    "velocity products",
    "gravity",
    "external force",
    "friction",
];
/// The joints by the number of their link.
const JOINTS: [&str; 2] = ["joint 1", "joint 4"];

impl RunReport<'_> {
    pub(super) fn add_loads(&self, page: &mut Page) {
        self.add_torques(page);
        if self.shows(Signal::Current) {
            self.add_currents(page);
        }
    }

    fn add_torques(&self, page: &mut Page) {
        page.heading("Torques");
        let series = |value: fn(&Sample, usize) -> f64, joint| -> Vec<Point> {
            let point = |sample: &Sample| [sample.time, value(sample, joint)];
            self.trace.samples().iter().map(point).collect()
        };
        let mut chart = Chart::new("Motor torque at the joints", "time [s]", "torque [N·m]");
        for (joint, name) in JOINTS.into_iter().enumerate() {
            chart = chart.line(name, series(|sample, joint| sample.torque[joint], joint));
        }
        page.chart(&chart);
        let Ok(model) = ShareModel::new(self.robot) else {
            return;
        };
        let shares: Vec<(f64, TorqueComponents<f64>)> = spaced(self.trace.samples(), SHARE_SAMPLES)
            .filter_map(|sample| Some((sample.time, model.shares(sample).ok()?)))
            .collect();
        let mut totals = ShareTotals::default();
        for pair in shares.windows(2) {
            totals.add(&pair[0].1, pair[1].0 - pair[0].0);
        }
        let (fractions, peaks) = (totals.fractions(), totals.peaks());
        // A cause that is zero everywhere, such as gravity on a level table, is not drawn.
        let causes: Vec<usize> = (0..peaks.len())
            .filter(|&cause| peaks[cause].iter().any(|&peak| peak > 0.0))
            .collect();
        page.paragraph(
            "The motor torques that the reference motion needs by the controller's model, \
             separated by cause.",
        );
        for (joint, name) in JOINTS.into_iter().enumerate() {
            let mut chart = Chart::new(
                format!("Torque of {name} by cause"),
                "time [s]",
                "torque [N·m]",
            );
            for &cause in &causes {
                let points = shares
                    .iter()
                    .map(|(time, shares)| [*time, shares.parts()[cause][joint]]);
                chart = chart.line(CAUSES[cause], points.collect());
            }
            page.chart(&chart);
        }
        let rows = CAUSES.into_iter().zip(fractions.into_iter().zip(peaks));
        let rows = rows.map(|(cause, ([part1, part4], [peak1, peak4]))| {
            vec![
                cause.to_owned(),
                format!("{:.1} %", 100.0 * part1),
                quantity(peak1, "N·m"),
                format!("{:.1} %", 100.0 * part4),
                quantity(peak4, "N·m"),
            ]
        });
        let header = ["cause", "joint 1", "greatest", "joint 4", "greatest"];
        page.table(&header, &rows.collect::<Vec<_>>());
        page.paragraph("Percentages are of ∫|τ| dt, summed over all causes.");
    }

    fn add_currents(&self, page: &mut Page) {
        page.heading("Currents");
        let samples = self.trace.samples();
        let line = |value: &dyn Fn(&Sample) -> f64| -> Vec<Point> {
            samples
                .iter()
                .map(|sample| [sample.time, value(sample)])
                .collect()
        };
        let Ok(drives) = self.robot.drives() else {
            return;
        };
        for (joint, name) in JOINTS.into_iter().enumerate() {
            let limit = drives[joint].peak_current;
            let greatest = samples.iter().map(|sample| sample.current[joint].abs());
            let mut chart = Chart::new(
                format!("Current of {name}"),
                "time [s]",
                "motor current [A]",
            )
            .line("current", line(&|sample| sample.current[joint]))
            .line("set-point", line(&|sample| sample.current_set_point[joint]));
            // A limit far away would make the curves flat.
            if greatest.fold(0.0, f64::max) > 0.5 * limit {
                let ends = [samples.first(), samples.last()].into_iter().flatten();
                let rim = |level: f64| ends.clone().map(|s| [s.time, level]).collect();
                chart = chart
                    .dashed("peak current", rim(limit))
                    .dashed("", rim(-limit));
            }
            page.chart(&chart);
        }
        // Drives on a bus have bridges of their own.
        if self.shows(Signal::BusVoltage) {
            let mut chart = Chart::new("Duty of the bridges", "time [s]", "duty [1]");
            for (joint, name) in JOINTS.into_iter().enumerate() {
                chart = chart.line(name, line(&|sample| sample.duty[joint]));
            }
            page.chart(&chart);
        }
        let limited = |sample: &Sample| if sample.saturated { 1.0 } else { f64::NAN };
        if samples.iter().any(|sample| sample.saturated) {
            page.chart(
                &Chart::new("Samples with a limited torque", "time [s]", "limited [1]")
                    .dots("limited", line(&limited)),
            );
        } else {
            page.paragraph("No torque was limited in any of the samples shown.");
        }
    }
}
