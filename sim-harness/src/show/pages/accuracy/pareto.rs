//! Contributions as horizontal bars.

use quick_xml::escape::escape;
use std::fmt::Write as _;

/// One bar for each name and share, in the given order.
pub(super) fn pareto(shares: &[(&str, f64)]) -> String {
    let height = 26 * shares.len();
    let longest = shares.iter().map(|(name, _)| name.chars().count()).max();
    let left = 12 + 8 * longest.unwrap_or(0);
    let width = left + 490;
    let mut svg = format!("<svg viewBox=\"0 0 {width} {height}\" width=\"{width}\" role=\"img\">");
    for (row, (name, share)) in shares.iter().enumerate() {
        let (y, percent) = (26 * row, 100.0 * share);
        let name = escape(*name);
        let bar = 4.0 * percent;
        let _ = write!(
            svg,
            "<text x=\"{left}\" y=\"{}\" text-anchor=\"end\" fill=\"currentColor\" font-size=\"14\">{name}</text>\
             <rect x=\"{}\" y=\"{}\" width=\"{bar:.1}\" height=\"16\" fill=\"currentColor\" opacity=\"0.6\"/>\
             <text x=\"{:.1}\" y=\"{}\" fill=\"currentColor\" font-size=\"14\">{percent:.1} %</text>",
            y + 18,
            left + 8,
            y + 5,
            (left + 14) as f64 + bar,
            y + 18,
        );
    }
    svg + "</svg>"
}
