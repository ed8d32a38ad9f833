//! The page of mobility analyses.

use crate::html::Page;
use crate::study::mobility::MobilityAnalysis;
use crate::text::steps;
use fivebar_files::mobility::MobilityCase;

/// The page of one or more mechanisms.
pub fn mobility(studies: &[(MobilityCase, MobilityAnalysis)]) -> Page {
    let mut page = Page::new("Mobility by screw theory");
    page.paragraph(
        "A twist (ω; v) or a wrench (f; m) is a screw. A limb constrains the platform by the \
         wrenches that do no work on any of its joints: those reciprocal to all its twists. The \
         numbers of these wrenches, and of the common and redundant ones among them, give the \
         freedoms of the platform. Lengths are in the file's unit.",
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
