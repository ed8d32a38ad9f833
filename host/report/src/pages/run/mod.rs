//! The report of a run: the motion, its errors and its loads.

mod by_cause;
mod loads;
mod motion;
mod picture;
mod shares;
mod speed;
#[cfg(test)]
mod tests;

use crate::html::{Chart, Page, Point};
use crate::text::quantity;
use fivebar_files::job::Job;
use fivebar_files::robot::Robot;
use fivebar_kinematics::five_bar::Joint;
use fivebar_sim::simulation::{Sample, Summary, Trace};

/// The content of a run's report.
#[derive(Clone, Copy, Debug)]
pub struct RunReport<'a> {
    /// The arm that ran.
    pub robot: &'a Robot,
    /// The job, if the run had one.
    pub job: Option<&'a Job>,
    /// The figures of the run.
    pub summary: &'a Summary,
    /// The samples of the run.
    pub trace: &'a Trace,
    /// The same run with PID at each joint, feed-forward of acceleration and friction,
    /// and equal bandwidths.
    pub pid: Option<(&'a Summary, &'a Trace)>,
    /// Which fault stopped the arm, when, why, and what to do; none without a fault.
    pub stopped: Option<&'a str>,
    /// The conditions of the run, by name and value.
    pub conditions: &'a [(String, String)],
}

impl RunReport<'_> {
    /// The report as a page.
    pub fn page(&self) -> Page {
        let summary = self.summary;
        let mut page = Page::new(format!("{} draws {}", summary.robot, summary.scenario));
        if summary.faults.is_empty() {
            page.paragraph(&self.outcome());
        } else {
            page.failure(&self.outcome());
        }
        let time = summary.job_s.map(|time| format!("{time:.2} s"));
        let time = [("job time", time.unwrap_or_else(|| "–".into()))];
        let figures = [
            ("RMS tip error", quantity(summary.tip_error.rms_m, "m")),
            ("greatest tip error", quantity(summary.tip_error.max_m, "m")),
            ("peak torque, of the limit", self.torque_used()),
            ("peak current, of the limit", self.current_used()),
        ];
        if self.trace.samples().is_empty() {
            page.key_figures(&time);
        } else {
            page.key_figures(&[&time[..], &figures].concat());
            self.add_motion(&mut page);
            self.add_speed(&mut page);
            self.add_errors(&mut page);
            self.add_causes(&mut page);
            self.add_loads(&mut page);
        }
        self.add_tables(&mut page);
        page
    }

    fn outcome(&self) -> String {
        let faults = &self.summary.faults;
        let unbegun = if self.trace.samples().is_empty() {
            " The job had not begun."
        } else {
            ""
        };
        if faults.is_empty() {
            "The job was done without a fault. All figures below are of the simulated arm itself, \
             not of the controller's estimates."
                .into()
        } else if let Some(stopped) = self.stopped {
            format!("{stopped}{unbegun}")
        } else {
            format!(
                "The run ended with a fault: {}.{unbegun}",
                faults.join(", ")
            )
        }
    }

    /// The greatest torque as a share of what the motor can give at its joint; at the joint where
    /// this is greatest.
    fn torque_used(&self) -> String {
        let settings = self.robot.settings().ok();
        let checked = settings.and_then(|settings| settings.check().ok());
        let limits = checked.map(|settings| settings.peak_torque().map(f64::from));
        share(self.summary.peak_torque_nm, limits)
    }

    /// The greatest current as a share of the peak current of its motor.
    fn current_used(&self) -> String {
        let greatest = [0, 1].map(|joint| {
            let samples = self.trace.samples().iter();
            let currents = samples.map(|sample| sample.current[joint].abs());
            currents.fold(0.0, f64::max)
        });
        let limits = self.robot.drives().ok();
        share(
            greatest,
            limits.map(|drives| drives.map(|d| d.peak_current)),
        )
    }

    fn add_errors(&self, page: &mut Page) {
        let microns = |trace: &Trace| {
            let point = |sample: &Sample| [sample.time, 1e6 * sample.tip_error()];
            trace.samples().iter().map(point).collect::<Vec<Point>>()
        };
        page.heading("Tip error").paragraph(
            "Distance of the tool from its reference at the same instant, so that a lag is an \
             error too.",
        );
        let chart = Chart::new("Tip error", "time [s]", "tip error [µm]");
        let own = microns(self.trace);
        match self.pid {
            None => page.chart(&chart.line("computed torque", own)),
            Some((pid, pid_trace)) => {
                page.chart(
                    &chart
                        .line("computed torque", own)
                        .line("PID with feed-forward", microns(pid_trace)),
                );
                let (ours, theirs) = (self.summary.tip_error, pid.tip_error);
                page.table(
                    &["controller", "RMS", "greatest"],
                    &[("computed torque", ours), ("PID with feed-forward", theirs)].map(
                        |(name, error)| {
                            let figures = [error.rms_m, error.max_m].map(|e| quantity(e, "m"));
                            let [rms, max] = figures;
                            vec![name.to_owned(), rms, max]
                        },
                    ),
                );
                match self.summary.ratio_to(theirs) {
                    None => page,
                    Some(ratio) => page.paragraph(&format!(
                        "With a PID at each joint, equal bandwidths, and feed-forward of acceleration and \
                         friction, but without the arm's model, the RMS error is {ratio:.1} times as large."
                    )),
                }
            }
        };
    }

    fn add_tables(&self, page: &mut Page) {
        let summary = self.summary;
        let mut rows = vec![
            row("simulated time", format!("{:.4} s", summary.simulated_s)),
            row("real time", quantity(summary.wall_s, "s")),
            row("speed", format!("{}× real time", summary.speed())),
            row("ticks", summary.ticks.to_string()),
            row(
                "ticks with a limited torque",
                summary.saturated_ticks.to_string(),
            ),
        ];
        for (joint, torque) in Joint::ALL.into_iter().zip(summary.peak_torque_nm) {
            rows.push(row(
                &format!("peak torque, {joint}"),
                quantity(torque, "N·m"),
            ));
        }
        rows.extend(
            self.conditions
                .iter()
                .map(|(name, value)| row(name, value.clone())),
        );
        page.heading("Figures").table(&["quantity", "value"], &rows);
        let warnings = self.job.map_or(&[][..], |job| &job.warnings);
        if !warnings.is_empty() {
            let text: Vec<_> = warnings.iter().map(ToString::to_string).collect();
            page.heading("Notes on the job").paragraph(&text.join("; "));
        }
    }

    /// Whether the tool is down or on at a sample, by the controller's output. Without a job every
    /// sample counts.
    fn draws(&self, sample: &Sample) -> bool {
        self.job.is_none() || sample.tool_level > 0.0
    }
}

/// The greater share of a limit, one of each joint; "–" where there is none.
fn share(values: [f64; 2], limits: Option<[f64; 2]>) -> String {
    let shares = limits.map(|limits| [0, 1].map(|joint| values[joint] / limits[joint]));
    let greatest = shares.map(|[one, four]| one.max(four));
    match greatest.filter(|share| share.is_finite()) {
        Some(share) => format!("{:.0} %", 100.0 * share),
        None => "–".into(),
    }
}

fn row(name: &str, value: String) -> Vec<String> {
    vec![name.to_owned(), value]
}

/// About `count` of the samples, evenly spaced.
fn spaced(samples: &[Sample], count: usize) -> impl Iterator<Item = &Sample> {
    samples.iter().step_by(samples.len().div_ceil(count).max(1))
}
