//! The answer as a page to hand to a student.

use crate::input::mobility::MobilityCase;
use crate::show::report::Page;
use crate::show::text::steps;
use crate::study::mobility::MobilityAnalysis;

/// The analysis of one or more studies.
pub fn mobility(studies: &[(MobilityCase, MobilityAnalysis)]) -> Page {
    let mut page = Page::new("Mobility by screw theory");
    page.paragraph(
        "A twist (ω; v) or a wrench (f; m) is a screw. A limb can only push on the platform \
         by wrenches that do no work on any of its joints: those reciprocal to all its \
         twists. Counting them, common ones, redundant ones and all, tells what the platform \
         can do. Lengths are in the file's unit.",
    );
    let summary: Vec<Vec<String>> = studies
        .iter()
        .map(|(study, analysis)| {
            let m = analysis.mobility();
            let mut row = vec![study.name.clone()];
            row.extend([m.lambda, m.order, m.redundant].map(|count| count.to_string()));
            row.push(m.m_eq7.to_string());
            row.extend([m.platform_dof, m.instantaneous, m.finite].map(|c| c.to_string()));
            row
        })
        .collect();
    page.table(
        &[
            "mechanism",
            "λ",
            "d",
            "v",
            "M (7)",
            "platform",
            "instantaneous",
            "finite",
        ],
        &summary,
    );
    for (study, analysis) in studies {
        page.heading(&study.name);
        if !study.description.is_empty() {
            page.paragraph(&study.description);
        }
        for (number, (heading, sentences)) in steps(analysis).into_iter().enumerate() {
            page.paragraph(&format!(
                "{}. {heading}. {}",
                number + 1,
                sentences.join(" ")
            ));
        }
    }
    page
}
