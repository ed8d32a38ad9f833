//! The page of the accuracy of a slider-driven mechanism.

use super::pareto::pareto;
use crate::html::Page;
use crate::text::quantity;
use fivebar_design::accuracy::slider::{SliderAnalysis, SliderMonteCarlo};
use fivebar_files::robot::SliderRobot;

/// The page for one position of P.
pub fn slider_page(
    robot: &SliderRobot,
    analysis: &SliderAnalysis,
    sampled: &SliderMonteCarlo,
) -> Page {
    let mut page = Page::new(format!("Accuracy of {}", robot.name));
    let p = analysis.pose.p;
    page.paragraph(&format!(
        "P at ({:.4}, {:.4}) m; {} samples from seed {}. The scatter is of first order. \
         Clearances are kineto-static: every pin stays in contact. Each parallelogram counts as \
         one limb.",
        p.x, p.y, sampled.sampling.samples, sampled.sampling.seed
    ));
    let deviations = analysis.position.deviations();
    let (twin, distance) = (&sampled.position, &sampled.distance);
    let row = |name: &str, value: f64, twin: f64, sign: &str| {
        let twin = format!("{sign}{}", quantity(twin, "m"));
        vec![name.to_string(), quantity(value, "m"), twin]
    };
    let clearance = &analysis.clearance;
    let rows = [
        row(
            "standard deviation in x",
            deviations[0],
            twin.deviation(0),
            "",
        ),
        row(
            "standard deviation in y",
            deviations[1],
            twin.deviation(1),
            "",
        ),
        row(
            "sliders' errors, exact worst case",
            analysis.input_worst,
            distance.largest[0],
            "≤ ",
        ),
        row(
            "clearances, exact worst case",
            clearance.worst,
            distance.largest[1],
            "≤ ",
        ),
        row(
            "clearances, root mean square",
            clearance.rms,
            distance.rms(1),
            "",
        ),
    ];
    page.table(&["figure", "analytic", "sampled"], &rows);
    page.heading("Who contributes");
    let mut shares = analysis.shares();
    shares.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    page.figure(
        &pareto(&shares),
        "Share of each dimension in the variance of P's position.",
    );
    page
}
