//! The page of a linkage's accuracy.

use super::pareto::pareto;
use crate::html::{Chart, Page};
use crate::study::accuracy::drive_name;
use crate::text::quantity;
use fivebar_design::accuracy::linkage::{LinkageAnalysis, LinkageStudy, ResultKind};
use fivebar_files::linkage::{DrivenLinkage, reaction_names};

/// Whether a result belongs on a chart.
type Belongs = fn(&ResultKind) -> bool;

/// The limits of the model, stated on the page.
const LIMITS: &str = "First order: errors are small compared with lengths and distances from \
    singularities. Clearances are kineto-static: massless links between pin and bearing, and \
    every pin stays in contact. Forces have the ideal moment arms.";

/// The page of a linkage.
pub fn linkage_page(driven: &DrivenLinkage, study: &LinkageStudy) -> Page {
    let mut page = Page::new(format!("Accuracy of {}", driven.name));
    let (instant, sampled) = (&study.instant, &study.sampled);
    page.paragraph(&format!(
        "At {} s of the sweep; {} samples from seed {}. {LIMITS}",
        instant.time, study.sampling.samples, study.sampling.seed
    ));
    if !instant.settled {
        page.paragraph(
            "The search for the clearance equilibrium does not converge here: a reaction is near \
             zero, and its pin is about to lose contact.",
        );
    }
    let deviations = instant.scatter.deviations();
    let rows: Vec<Vec<String>> = instant
        .results
        .iter()
        .enumerate()
        .filter(|&(row, _)| deviations[row] > 0.0)
        .map(|(row, result)| {
            let (name, unit) = named(driven, result);
            let twin = sampled.deviation(row);
            let error = twin * sampled.relative_error();
            vec![
                name,
                quantity(instant.values[row], unit),
                quantity(deviations[row], unit),
                format!("{} ± {}", quantity(twin, unit), quantity(error, unit)),
            ]
        })
        .collect();
    page.table(&["figure", "value", "standard deviation", "sampled"], &rows);
    page.heading("Contributions");
    for (row, result) in instant.results.iter().enumerate() {
        let rows = match result {
            ResultKind::Position(_, 0) => 2,
            ResultKind::Drive(_) => 1,
            _ => continue,
        };
        let shares = instant.shares(row, rows);
        let bars = shares.iter().take(12).filter(|(_, share)| *share > 1e-3);
        let bars: Vec<(&str, f64)> = bars
            .map(|&(i, share)| (instant.primitives[i].name.as_str(), share))
            .collect();
        if !bars.is_empty() {
            let (name, _) = named(driven, result);
            let of = name.trim_end_matches(" x");
            page.figure(&pareto(&bars), &format!("Share in the variance of: {of}."));
        }
    }
    page.heading("Over the sweep");
    let groups: [(&str, &str, Belongs); 5] = [
        ("Positions", "m", |f| matches!(f, ResultKind::Position(..))),
        ("Velocities", "m/s", |f| {
            matches!(f, ResultKind::Velocity(..))
        }),
        ("Accelerations", "m/s²", |f| {
            matches!(f, ResultKind::Acceleration(..))
        }),
        ("Drives", "N·m or N", |f| matches!(f, ResultKind::Drive(_))),
        ("Joint forces", "N", |f| matches!(f, ResultKind::Force(..))),
    ];
    for (title, unit, belongs) in groups {
        let y_label = format!("standard deviation [{unit}]");
        let mut chart = Chart::new(title, "time [s]", y_label.as_str());
        for (row, result) in instant.results.iter().enumerate() {
            if belongs(result) {
                let deviation = |analysis: &LinkageAnalysis| {
                    analysis.scatter.covariance[(row, row)].max(0.0).sqrt()
                };
                let instants = study.sweep.iter();
                let curve = instants.map(|analysis| [analysis.time, deviation(analysis)]);
                chart = chart.line(named(driven, result).0, curve.collect());
            }
        }
        page.chart(&chart);
    }
    page
}

/// The name of a result, and its unit.
fn named(driven: &DrivenLinkage, result: &ResultKind) -> (String, &'static str) {
    let point = |index: usize| &driven.linkage.points()[index].name;
    let link = |index: usize| &driven.linkage.links()[index].name;
    let joint = |index: usize| reaction_names(&driven.linkage).swap_remove(index);
    let axis = |component: usize| ["x", "y"][component];
    match *result {
        ResultKind::Position(p, i) => (format!("position of {} {}", point(p), axis(i)), "m"),
        ResultKind::Velocity(p, i) => (format!("velocity of {} {}", point(p), axis(i)), "m/s"),
        ResultKind::Acceleration(p, i) => {
            (format!("acceleration of {} {}", point(p), axis(i)), "m/s²")
        }
        ResultKind::Angle(l) => (format!("angle of {}", link(l)), "rad"),
        ResultKind::AngularVelocity(l) => (format!("angular velocity of {}", link(l)), "rad/s"),
        ResultKind::AngularAcceleration(l) => {
            (format!("angular acceleration of {}", link(l)), "rad/s²")
        }
        ResultKind::Drive(k) => {
            let (name, what, unit) = drive_name(driven, k);
            let unit = if unit == "nm" { "N·m" } else { "N" };
            (format!("driving {what} of {name}"), unit)
        }
        ResultKind::Force(j, i) => (format!("force of {} {}", joint(j), axis(i)), "N"),
        ResultKind::Moment(j) => (format!("moment of {}", joint(j)), "N·m"),
    }
}
