//! The page of the study of wear.

use crate::html::{Chart, Page, Point};
use crate::study::clearance::{ClearanceStudy, NAMES, Outcome};
use crate::text::quantity;

/// The page: all runs beside that of the new arm.
pub fn clearance(study: &ClearanceStudy, conditions: &[(String, String)]) -> Page {
    let mut page = Page::new(format!(
        "{} with worn joints: {}",
        study.robot, study.scenario
    ));
    page.paragraph(
        "The same job under the production control loop, with the new arm and with clearance in \
         its joints. Pins fly, strike and slide in their bearings. The controller's model has no \
         clearance, and its encoders measure the driven links.",
    );
    add_errors(&mut page, study);
    page.heading("New and worn");
    page.table(
        &[
            "radial clearance",
            "tip error RMS",
            "greatest",
            "added by clearance, RMS",
            "greatest",
            "peak torque",
            "peak reaction",
            "impacts",
            "fault",
        ],
        &study.outcomes.iter().map(row).collect::<Vec<_>>(),
    );
    page.paragraph(
        "Added by clearance: the distance between the error vectors of this arm and of the new \
         arm at the same time, on the job's path without the motion from home.",
    );
    add_prediction(&mut page, study);
    add_joints(&mut page, study);
    page.heading("Conditions");
    let rows = conditions.iter();
    let rows: Vec<_> = rows
        .map(|(name, value)| vec![name.clone(), value.clone()])
        .collect();
    page.table(&["condition", "value"], &rows);
    page
}

fn label(outcome: &Outcome) -> String {
    match outcome.largest_clearance() {
        0.0 => "new".into(),
        clearance => quantity(clearance, "m"),
    }
}

fn greatest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, f64::max)
}

fn peak_reaction(outcome: &Outcome) -> f64 {
    greatest(outcome.record.joints.total.map(|joint| joint.peak_force))
}

fn row(outcome: &Outcome) -> Vec<String> {
    let summary = &outcome.summary;
    let impacts: u32 = outcome.record.joints.total.iter().map(|j| j.impacts).sum();
    let fault = summary.faults.first();
    vec![
        label(outcome),
        quantity(summary.tip_error.rms_m, "m"),
        quantity(summary.tip_error.max_m, "m"),
        quantity(outcome.added.rms_m, "m"),
        quantity(outcome.added.max_m, "m"),
        quantity(greatest(summary.peak_torque_nm), "N·m"),
        quantity(peak_reaction(outcome), "N"),
        impacts.to_string(),
        fault.map_or_else(|| "none".into(), Clone::clone),
    ]
}

fn add_prediction(page: &mut Page, study: &ClearanceStudy) {
    page.heading("Predictions of the models without contact");
    let rows: Vec<_> = study
        .outcomes
        .iter()
        .map(|outcome| {
            vec![
                label(outcome),
                quantity(outcome.prediction.seated, "m"),
                quantity(outcome.prediction.worst, "m"),
                quantity(outcome.by_pins.max_m, "m"),
                quantity(outcome.added.max_m, "m"),
                quantity(greatest(outcome.prediction.reaction), "N"),
                quantity(peak_reaction(outcome), "N"),
            ]
        })
        .collect();
    page.table(
        &[
            "radial clearance",
            "predicted, equilibrium",
            "predicted, worst case",
            "simulated, by the pins",
            "simulated, total",
            "predicted peak reaction",
            "simulated",
        ],
        &rows,
    );
    page.paragraph(
        "Equilibrium: the greatest displacement of C along the job, with every pin where its \
         reaction presses it. Worst case: over all positions of the pins, with the driven links \
         at their angles. By the pins: the distance of the tool from its position in an ideal \
         arm with the same angles of the driven links. Total: this includes the errors of these \
         angles after impacts, which models without contact cannot predict. The predicted \
         reactions are those of inertia at the feed rates, without ramps at corners.",
    );
}

fn add_errors(page: &mut Page, study: &ClearanceStudy) {
    let mut chart = Chart::new("Tip error", "time [s]", "tip error [µm]");
    for outcome in study.outcomes.iter().rev() {
        let samples = outcome.record.trace.samples().iter();
        let points: Vec<Point> = samples.map(|s| [s.time, 1e6 * s.tip_error()]).collect();
        chart = chart.line(label(outcome), points);
    }
    page.chart(&chart);
}

fn add_joints(page: &mut Page, study: &ClearanceStudy) {
    page.heading("Joints");
    let mut rows = Vec::new();
    for outcome in &study.outcomes {
        let flight = outcome.flight_share();
        for (k, joint) in outcome.record.joints.total.iter().enumerate() {
            let worn = outcome.clearance[k] > 0.0;
            let of_worn = |text: String| if worn { text } else { "–".into() };
            rows.push(vec![
                label(outcome),
                NAMES[k].into(),
                quantity(joint.peak_force, "N"),
                of_worn(joint.impacts.to_string()),
                of_worn(quantity(joint.fastest_impact, "m/s")),
                of_worn(joint.flights.to_string()),
                of_worn(format!("{:.0} %", 100.0 * flight[k])),
            ]);
        }
    }
    page.table(
        &[
            "radial clearance",
            "joint",
            "peak reaction",
            "impacts",
            "fastest impact",
            "flights",
            "time without contact",
        ],
        &rows,
    );
    for (k, name) in NAMES.into_iter().enumerate() {
        let title = format!("Reaction in {name}: greatest value of each millisecond");
        let mut chart = Chart::new(title, "time [s]", "force [N]");
        for outcome in study.outcomes.iter().rev() {
            let peaks = outcome.record.joints.peaks.iter();
            let points: Vec<Point> = peaks.map(|peak| [peak.time, peak.force[k]]).collect();
            chart = chart.line(label(outcome), points);
        }
        page.chart(&chart);
    }
    let mut chart = Chart::new("Motor torque of joint 1", "time [s]", "torque [N·m]");
    for outcome in study.outcomes.iter().rev() {
        let samples = outcome.record.trace.samples().iter();
        let points: Vec<Point> = samples.map(|s| [s.time, s.torque[0]]).collect();
        chart = chart.line(label(outcome), points);
    }
    page.chart(&chart);
}
