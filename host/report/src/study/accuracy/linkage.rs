//! The accuracy of a linkage, and its JSON; the units are in the keys. The Monte Carlo figures
//! have the same keys.

use super::error::AccuracyStudyError;
use crate::study::linkage::explain;
use fivebar_design::accuracy::linkage::{self, LinkageAnalysis, LinkageStudy, ResultKind};
use fivebar_design::accuracy::{Progress, Sampling};
use fivebar_files::linkage::{DrivenLinkage, driven_links, reaction_names};
use serde_json::{Map, Value, json};

/// Least share of a variance for a contributor to be listed.
const LEAST_SHARE: f64 = 1e-6;

/// Analyses a linkage over its sweep, and at `time` [s] also by sampling.
///
/// # Errors
/// `Linkage` with the reason why the linkage has no results at this time.
pub fn study_linkage(
    driven: &DrivenLinkage,
    time: f64,
    sampling: Sampling,
    progress: Progress<'_>,
) -> Result<LinkageStudy, AccuracyStudyError> {
    let (duration, steps) = (driven.duration, driven.steps);
    let toleranced = driven.toleranced();
    linkage::study_linkage(&toleranced, duration, steps, time, sampling, progress).map_err(
        |error| AccuracyStudyError::Linkage {
            time,
            explanation: explain(driven, &error),
        },
    )
}

/// One JSON object: the chosen instant with all figures, then the sweep.
pub fn linkage_answer(driven: &DrivenLinkage, study: &LinkageStudy) -> Value {
    let instant = &study.instant;
    let deviations = instant.scatter.deviations();
    let mut answer = by_figure(driven, instant, "", |i| instant.values[i]);
    merge(
        &mut answer,
        by_figure(driven, instant, "sd_", |i| deviations[i]),
    );
    let sampled = &study.sampled;
    let mut twins = by_figure(driven, instant, "sd_", |i| sampled.deviation(i));
    twins["samples"] = json!(study.sampling.samples);
    twins["seed"] = json!(study.sampling.seed);
    twins["failed"] = json!(sampled.failed);
    twins["relative_error_of_sd"] = json!(sampled.relative_error());
    for (index, error) in instant.point_errors.iter().enumerate() {
        let name = &driven.linkage.points()[index].name;
        if let Some(error) = error {
            let point = &mut answer["points"][name];
            point["clearance_worst_linear_m"] = json!(error.clearance_worst);
            point["clearance_rms_m"] = json!(error.clearance_rms);
            point["input_worst_m"] = json!(error.input_worst);
        }
    }
    for (row, result) in instant.results.iter().enumerate() {
        let (group, name, rows) = match *result {
            ResultKind::Position(point, 0) => {
                let name = &driven.linkage.points()[point].name;
                let entry = |i, j| instant.scatter.covariance[(row + i, row + j)];
                answer["points"][name]["position_covariance"] =
                    json!([[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]);
                ("points", driven.linkage.points()[point].name.clone(), 2)
            }
            ResultKind::Drive(drive) => ("driving", drive_name(driven, drive).0, 1),
            _ => continue,
        };
        answer[group][&name]["contributors"] = contributors(instant, row, rows);
    }
    answer["linkage"] = json!(driven.name);
    answer["time_s"] = json!(instant.time);
    answer["inputs"] = instant.inputs.iter().map(|input| input.value).collect();
    answer["clearances_settled"] = json!(instant.settled);
    answer["monte_carlo"] = twins;
    answer["sweep"] = sweep(driven, study);
    answer
}

/// The shares of all contributors in the variance of `rows` results from `row` on, the
/// greatest first.
fn contributors(analysis: &LinkageAnalysis, row: usize, rows: usize) -> Value {
    analysis
        .shares(row, rows)
        .into_iter()
        .filter(|(_, share)| *share >= LEAST_SHARE)
        .map(|(i, share)| {
            let primitive = &analysis.primitives[i];
            json!({"name": primitive.name, "sd": primitive.deviation, "share": share})
        })
        .collect()
}

/// Standard deviations at every instant of the sweep, and the greatest of each.
fn sweep(driven: &DrivenLinkage, study: &LinkageStudy) -> Value {
    let stations: Vec<Value> = study
        .sweep
        .iter()
        .map(|analysis| {
            let deviations = analysis.scatter.deviations();
            let mut station = by_figure(driven, analysis, "sd_", |i| deviations[i]);
            station["time_s"] = json!(analysis.time);
            station["clearances_settled"] = json!(analysis.settled);
            station
        })
        .collect();
    let mut worst = vec![0.0_f64; study.instant.results.len()];
    for analysis in &study.sweep {
        let deviations = analysis.scatter.deviations();
        for (worst, deviation) in worst.iter_mut().zip(deviations.iter()) {
            *worst = worst.max(*deviation);
        }
    }
    json!({
        "instants": driven.steps + 1,
        "closed": study.sweep.len(),
        "worst": by_figure(driven, &study.instant, "sd_", |i| worst[i]),
        "stations": stations,
    })
}

/// A number for each result, under `points`, `links`, `driving` and `reactions`.
fn by_figure(
    driven: &DrivenLinkage,
    analysis: &LinkageAnalysis,
    prefix: &str,
    value: impl Fn(usize) -> f64,
) -> Value {
    let linkage = &driven.linkage;
    let joints = reaction_names(linkage);
    let mut answer = json!({"points": {}, "links": {}, "driving": {}, "reactions": {}});
    for (row, result) in analysis.results.iter().enumerate() {
        let point = |index: usize| ("points", linkage.points()[index].name.clone());
        let link = |index: usize| ("links", linkage.links()[index].name.clone());
        let joint = |index: usize| ("reactions", joints[index].clone());
        let pair = || json!([value(row), value(row + 1)]);
        let one = || json!(value(row));
        let ((group, name), what, unit, entry) = match *result {
            ResultKind::Position(index, 0) => (point(index), "position", "m", pair()),
            ResultKind::Velocity(index, 0) => (point(index), "velocity", "m_s", pair()),
            ResultKind::Acceleration(index, 0) => (point(index), "acceleration", "m_s2", pair()),
            ResultKind::Angle(index) => (link(index), "angle", "rad", one()),
            ResultKind::AngularVelocity(index) => (link(index), "rate", "rad_s", one()),
            ResultKind::AngularAcceleration(index) => {
                (link(index), "acceleration", "rad_s2", one())
            }
            ResultKind::Drive(index) => {
                let (name, what, unit) = drive_name(driven, index);
                (("driving", name), what, unit, one())
            }
            ResultKind::Force(index, 0) => (joint(index), "force", "n", pair()),
            ResultKind::Moment(index) => (joint(index), "moment", "nm", one()),
            // The second component is with the first.
            ResultKind::Position(..)
            | ResultKind::Velocity(..)
            | ResultKind::Acceleration(..)
            | ResultKind::Force(..) => continue,
        };
        answer[group][&name][format!("{what}_{prefix}{unit}")] = entry;
    }
    answer
}

/// The name of a driven link, and quantity and unit of its drive.
pub(crate) fn drive_name(
    driven: &DrivenLinkage,
    drive: usize,
) -> (String, &'static str, &'static str) {
    let mut links = driven_links(&driven.linkage);
    let (name, unit) = links.nth(drive).unwrap_or_default();
    let (what, unit) = if unit == "rad" {
        ("torque", "nm")
    } else {
        ("force", "n")
    };
    (name.into(), what, unit)
}

/// Merges `from` into `into`, also within nested objects.
fn merge(into: &mut Value, from: Value) {
    match (into, from) {
        (Value::Object(into), Value::Object(from)) => {
            for (key, value) in from {
                merge(into.entry(key).or_insert(Value::Object(Map::new())), value);
            }
        }
        (into, from) => *into = from,
    }
}
