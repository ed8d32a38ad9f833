//! What the motion took: torques by share, currents, duties.

use super::shares::{ShareModel, Shares};
use super::{RunReport, spaced};
use crate::report::{Chart, Page, Point};
use crate::run::Sample;

/// Samples looked at for the shares of the torques.
const SHARE_SAMPLES: usize = 20_000;
/// The joints by the number of their link.
const JOINTS: [&str; 2] = ["joint 1", "joint 4"];

impl RunReport<'_> {
    pub(super) fn add_loads(&self, page: &mut Page) {
        self.add_torques(page);
        self.add_currents(page);
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
        let shares: Vec<(f64, Shares)> = spaced(self.trace.samples(), SHARE_SAMPLES)
            .filter_map(|sample| Some((sample.time, model.shares(sample).ok()?)))
            .collect();
        page.paragraph(
            "What the reference motion asks of the motors by the controller's model, told \
             apart by cause.",
        );
        for (joint, name) in JOINTS.into_iter().enumerate() {
            let mut chart = Chart::new(
                format!("Torque of {name} by cause"),
                "time [s]",
                "torque [N·m]",
            );
            for (cause, (label, _)) in Shares::default().named().into_iter().enumerate() {
                let point =
                    |(time, shares): &(f64, Shares)| [*time, shares.named()[cause].1[joint]];
                chart = chart.line(label, shares.iter().map(point).collect());
            }
            page.chart(&chart);
        }
        page.table(&["cause", "joint 1", "joint 4"], &mean_shares(&shares));
        page.paragraph("The table has each cause's mean size, as a share of all four.");
    }

    fn add_currents(&self, page: &mut Page) {
        page.heading("Currents and voltages");
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
            // A limit far away would flatten the curves, and tell nothing.
            if greatest.fold(0.0, f64::max) > 0.5 * limit {
                let ends = [samples.first(), samples.last()].into_iter().flatten();
                let rim = |level: f64| ends.clone().map(|s| [s.time, level]).collect();
                chart = chart
                    .dashed("peak current", rim(limit))
                    .dashed("", rim(-limit));
            }
            page.chart(&chart);
        }
        let mut chart = Chart::new("Duty of the bridges", "time [s]", "duty [1]");
        for (joint, name) in JOINTS.into_iter().enumerate() {
            chart = chart.line(name, line(&|sample| sample.duty[joint]));
        }
        page.chart(&chart);
        let limited = |sample: &Sample| if sample.saturated { 1.0 } else { f64::NAN };
        if samples.iter().any(|sample| sample.saturated) {
            page.chart(
                &Chart::new("Where a torque was limited", "time [s]", "limited [1]")
                    .dots("limited", line(&limited)),
            );
        } else {
            page.paragraph("No torque was limited in any of the samples shown.");
        }
    }
}

/// Each cause's mean magnitude as a share of the sum of all, for either joint.
fn mean_shares(shares: &[(f64, Shares)]) -> Vec<Vec<String>> {
    let sums = Shares::default().named().map(|(label, _)| label);
    let sums = sums.into_iter().enumerate().map(|(cause, label)| {
        let size = |joint: usize| -> f64 {
            let sizes = shares
                .iter()
                .map(|(_, shares)| shares.named()[cause].1[joint].abs());
            sizes.sum()
        };
        (label, [size(0), size(1)])
    });
    let sums: Vec<_> = sums.collect();
    let total = [0, 1].map(|joint| sums.iter().map(|(_, sum)| sum[joint]).sum::<f64>());
    sums.iter()
        .map(|(label, sum)| {
            let percent = |joint: usize| match total[joint] {
                0.0 => "–".to_owned(),
                total => format!("{:.1} %", 100.0 * sum[joint] / total),
            };
            vec![(*label).to_owned(), percent(0), percent(1)]
        })
        .collect()
}
