//! The tip error by cause: the same run with each mismatch alone.

use super::RunReport;
use crate::html::{Bar, Page, bars};
use crate::text::quantity;
use fivebar_sim::simulation::CauseError;

impl RunReport<'_> {
    /// A table and bars, if the run was repeated with each mismatch alone.
    pub(super) fn add_causes(&self, page: &mut Page) {
        let causes = &self.summary.by_cause;
        let whole = |cause: &&CauseError| cause.faults.is_empty();
        let errors = causes.iter().filter(whole).map(|c| c.tip_error.rms_m);
        let greatest = errors.fold(f64::MIN_POSITIVE, f64::max);
        if causes.is_empty() {
            return;
        }
        page.heading("Tip error by cause").paragraph(
            "The same run without any mismatch, with each mismatch alone, and with all of them. \
             Errors of several causes do not add up: they may point the same way or cancel.",
        );
        // The column of the faults only where there are any.
        let columns = if causes.iter().any(|cause| !cause.faults.is_empty()) {
            4
        } else {
            3
        };
        let rows = causes.iter().map(|cause| {
            let [rms, max] = [cause.tip_error.rms_m, cause.tip_error.max_m];
            let mut row = vec![
                cause.cause.clone(),
                quantity(rms, "m"),
                quantity(max, "m"),
                cause.faults.join(", "),
            ];
            row.truncate(columns);
            row
        });
        let header = ["cause", "RMS", "greatest", "fault"];
        page.table(&header[..columns], &rows.collect::<Vec<_>>());
        let bar = |cause: &CauseError| {
            let rms = cause.tip_error.rms_m;
            match cause.faults.first() {
                Some(fault) => (0.0, format!("fault: {fault}")),
                None => (rms / greatest, quantity(rms, "m")),
            }
        };
        let list: Vec<Bar<'_>> = causes
            .iter()
            .map(|cause| {
                let (share, label) = bar(cause);
                Bar {
                    name: &cause.cause,
                    share,
                    label,
                }
            })
            .collect();
        page.figure(&bars(&list), "RMS tip error with each mismatch alone.");
    }
}
