//! What a maker asks first: whether the drawing was finished, whether it has its size, and how far off it is.

use super::RunReport;
use crate::html::Page;
use crate::text::quantity;
use fivebar_sim::simulation::Sample;

/// How wide errors are, in things that everybody knows [m].
const SIZES: [(f64, &str); 3] = [
    (
        50e-6,
        "less than you see: a fine pen draws a line of 300 µm",
    ),
    (150e-6, "about a hair: you see it where lines should meet"),
    (
        f64::INFINITY,
        "visible: half the line of a fine pen, or more",
    ),
];

/// The width and the height of what these places cover [m].
fn extent(places: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    let nothing = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    let ends = places.fold(nothing, |ends, place| {
        [0, 1].map(|k| {
            let [least, most] = ends[k];
            [least.min(place[k]), most.max(place[k])]
        })
    });
    ends.map(|[least, most]| (most - least).max(0.0))
}

impl RunReport<'_> {
    /// The answers, above all else. A run that drew nothing has none.
    pub(super) fn add_answers(&self, page: &mut Page) {
        let drawn: Vec<&Sample> = self
            .trace
            .samples()
            .iter()
            .filter(|s| self.draws(s))
            .collect();
        if drawn.is_empty() {
            return;
        }
        let meant = extent(drawn.iter().map(|sample| sample.reference));
        let made = extent(drawn.iter().map(|sample| sample.tool));
        let verdict = &self.summary.verdict;
        let finished = match (verdict.drawn, self.summary.job_s) {
            (true, Some(time)) => format!("yes, in {time:.1} s"),
            (true, None) => "yes".into(),
            (false, _) => "no: see above".into(),
        };
        let off = [0, 1].map(|k| (made[k] - meant[k]).abs());
        let worst = off[0].max(off[1]);
        let size =
            |[width, height]: [f64; 2]| format!("{:.1} × {:.1} mm", 1e3 * width, 1e3 * height);
        let on_size = format!(
            "{}: {} were meant, {} drawn; width and height differ by {} at most",
            if worst <= verdict.tolerance_m {
                "yes"
            } else {
                "no"
            },
            size(meant),
            size(made),
            quantity(worst, "m"),
        );
        let far = verdict.worst_m;
        let wide = SIZES.into_iter().find(|&(most, _)| far < most);
        let far_off = format!(
            "{} at most, {}",
            quantity(far, "m"),
            wide.map_or("unknown", |(_, words)| words)
        );
        let answers = [
            ("Is it finished?", finished),
            ("Has it its size?", on_size),
            ("How far is it off?", far_off),
        ];
        let rows = answers.map(|(question, answer)| vec![question.to_owned(), answer]);
        page.table(&["question", "answer"], &rows);
    }
}
