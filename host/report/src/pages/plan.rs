//! The page of a time-optimal plan.

use crate::html::{Chart, Page};
use crate::study::plan::PlanStudy;
use fivebar_design::time_optimal::{Run, RunSample};

/// The page: figures, and for every run its phase plane and its torques.
pub fn plan(study: &PlanStudy, name: &str) -> Page {
    let mut page = Page::new(format!("Fastest motion along {name}"));
    page.key_figures(&[
        ("motion", format!("{:.2} ms", 1e3 * study.time())),
        (
            "a limit above 95 %",
            format!("{:.1} % of the time", 100.0 * study.active_share()),
        ),
        (
            "a limit is passed by",
            format!("{:.3} % at most", 100.0 * study.limit_excess()),
        ),
    ]);
    page.paragraph(
        "Above the maximum velocity curve no acceleration along the path satisfies all limits. The \
         fastest motion touches it at most, and elsewhere accelerates or brakes with some joint \
         at a limit.",
    );
    for (n, run) in study.runs.iter().enumerate() {
        page.heading(&format!("Run {}: {:.2} ms", n + 1, 1e3 * run.time));
        page.chart(&phase_plane(study, run));
        page.chart(&torques(study, run));
    }
    page
}

fn phase_plane(study: &PlanStudy, run: &Run) -> Chart {
    let fastest = run.samples.iter().map(|at| at.s_dot).fold(0.0, f64::max);
    // The curve is far above the motion in places; the chart shows what is near.
    let curve = |at: &RunSample| {
        let velocity = study.maximum_velocity(at);
        [
            at.s,
            if velocity < 3.0 * fastest {
                velocity
            } else {
                f64::NAN
            },
        ]
    };
    Chart::new("Phase plane", "path parameter s", "ṡ [unit of s / s]")
        .dashed(
            "maximum velocity curve",
            run.samples.iter().map(curve).collect(),
        )
        .line(
            "motion",
            run.samples.iter().map(|at| [at.s, at.s_dot]).collect(),
        )
}

fn torques(study: &PlanStudy, run: &Run) -> Chart {
    let share = |j: usize| {
        let limit = study.limits.torque[j];
        let points = run.samples.iter();
        points
            .map(|at| [1e3 * at.t, 100.0 * at.torque[j] / limit])
            .collect()
    };
    let end = 1e3 * run.time;
    Chart::new("Torque as a share of its limit", "time [ms]", "share [%]")
        .line("joint 1", share(0))
        .line("joint 4", share(1))
        .dashed("limits", vec![[0.0, 100.0], [end, 100.0]])
        .dashed("", vec![[0.0, -100.0], [end, -100.0]])
}
