//! The report of a run: the motion, its errors and its loads.

mod answers;
mod by_cause;
mod drives;
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
        if summary.verdict.drawn {
            page.paragraph(&self.outcome());
        } else {
            page.failure(&self.outcome());
        }
        self.add_answers(&mut page);
        let time = summary.job_s.map(|time| format!("{time:.2} s"));
        let time = [("job time", time.unwrap_or_else(|| "–".into()))];
        let figures = [
            ("RMS tip error", quantity(summary.tip_error.rms_m, "m")),
            ("greatest tip error", quantity(summary.tip_error.max_m, "m")),
        ];
        let figures = figures
            .into_iter()
            .map(|(name, value)| (name.to_owned(), value));
        let figures: Vec<(String, String)> = figures.chain(self.drive_figures()).collect();
        let figures = figures
            .iter()
            .map(|(name, value)| (name.as_str(), value.clone()));
        if self.trace.samples().is_empty() {
            page.key_figures(&time);
        } else {
            page.key_figures(&time.into_iter().chain(figures).collect::<Vec<_>>());
            self.add_motion(&mut page);
            self.add_speed(&mut page);
            self.add_errors(&mut page);
            self.add_causes(&mut page);
            self.add_loads(&mut page);
        }
        self.add_tables(&mut page);
        page
    }

    /// Whether the job was drawn, and why not.
    fn outcome(&self) -> String {
        let Summary {
            faults, verdict, ..
        } = self.summary;
        let unbegun = match self.trace.samples() {
            [] => " The job had not begun.",
            _ => "",
        };
        let why = match (self.stopped, faults.as_slice(), &verdict.why) {
            _ if verdict.drawn => {
                let [worst, allowed] =
                    [verdict.worst_m, verdict.tolerance_m].map(|length| quantity(length, "m"));
                let steps = match self.summary.lost_steps {
                    Some([0, 0]) => " No step was lost.",
                    _ => "",
                };
                return format!(
                    "Drawn: the tip was {worst} from its place at most while the tool was down, and {allowed} are \
                     allowed.{steps} All figures below are of the simulated arm itself, not of the controller's estimates."
                );
            }
            (Some(stopped), ..) => stopped.to_owned(),
            (None, [], Some(why)) => format!("{why}."),
            _ => format!("The run ended with a fault: {}.", faults.join(", ")),
        };
        format!("Not drawn. {why}{unbegun}")
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
        ];
        if self.limits_torques() {
            let ticks = summary.saturated_ticks.to_string();
            rows.push(row("ticks with a limited torque", ticks));
        }
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

fn row(name: &str, value: String) -> Vec<String> {
    vec![name.to_owned(), value]
}

/// About `count` of the samples, evenly spaced.
fn spaced(samples: &[Sample], count: usize) -> impl Iterator<Item = &Sample> {
    samples.iter().step_by(samples.len().div_ceil(count).max(1))
}
