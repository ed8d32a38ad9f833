//! The page of a board's test: the rows, and the times of the ticks.

use crate::html::{Chart, Page};
use fivebar_sim::board_test::{BoardReport, Histogram, Row};

/// The page.
pub fn board_test(report: &BoardReport) -> Page {
    let mut page = Page::new("Test of a bare board");
    page.paragraph(&format!(
        "Firmware {}, chip {}. The bridges drove no motor.",
        report.firmware, report.unique_id
    ));
    if report.simulated {
        page.paragraph(
            "This is the simulated chip: its times are instructions, not cycles, one for every two bytes of \
             code, without waits for the flash. Only silicon shows the cycles.",
        );
    }
    for row in report.failed() {
        if let Some((why, remedy)) = row.verdict.reason() {
            page.failure(&format!("{}: {why}. To do: {remedy}.", row.name));
        }
    }
    let cells = |row: &Row| {
        let (why, remedy) = row.verdict.reason().unwrap_or_default();
        let reason = match why {
            "" => String::new(),
            why => format!("{why}. To do: {remedy}."),
        };
        let [name, source] = [row.name, row.source].map(str::to_owned);
        let verdict = row.verdict.word().to_owned();
        vec![
            name,
            row.measured.clone(),
            row.bound.clone(),
            source,
            verdict,
            reason,
        ]
    };
    let rows: Vec<_> = report.rows.iter().map(cells).collect();
    page.table(
        &[
            "what",
            "measured",
            "bound",
            "source of the bound",
            "verdict",
            "reason",
        ],
        &rows,
    );
    if let Some(times) = &report.times {
        page.heading("Times of the ticks");
        page.paragraph(&format!("In {}, armed and on a path.", report.unit));
        page.chart(
            &Chart::new("Ticks by their time", "time [cycles]", "ticks")
                .line("interrupt", outline(&times.interrupt))
                .dashed("response", outline(&times.response)),
        );
    }
    page
}

/// The outline of a histogram, up to its last bin with ticks.
fn outline(times: &Histogram) -> Vec<[f64; 2]> {
    let last = times.bins.iter().rposition(|&ticks| ticks > 0);
    let bins = times.bins.iter().take(last.map_or(0, |last| last + 1));
    let width = f64::from(times.bin);
    let mut points = vec![[0.0, 0.0]];
    for (&ticks, place) in bins.zip(0_u32..) {
        let from = width * f64::from(place);
        points.extend([[from, f64::from(ticks)], [from + width, f64::from(ticks)]]);
    }
    let [end, _] = points.last().copied().unwrap_or_default();
    points.push([end, 0.0]);
    points
}
