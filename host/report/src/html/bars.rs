//! Values as horizontal bars.

use quick_xml::escape::escape;
use std::fmt::Write as _;

/// A bar.
#[derive(Clone, Debug)]
pub struct Bar<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its length as a share of the longest possible one.
    pub share: f64,
    /// The text beside it: its value with unit.
    pub label: String,
}

/// The bars below one another, as SVG.
pub fn bars(bars: &[Bar<'_>]) -> String {
    let height = 26 * bars.len();
    let longest = bars.iter().map(|bar| bar.name.chars().count()).max();
    let left = 12 + 8 * longest.unwrap_or(0);
    let width = left + 490;
    let mut svg = format!(
        "<svg viewBox=\"0 0 {width} {height}\" width=\"{width}\" role=\"img\" aria-label=\"Shares as bars\">"
    );
    for (row, Bar { name, share, label }) in bars.iter().enumerate() {
        let y = 26 * row;
        let (name, label) = (escape(*name), escape(label));
        let bar = 400.0 * share;
        let _ = write!(
            svg,
            "<text x=\"{left}\" y=\"{}\" text-anchor=\"end\" fill=\"currentColor\" font-size=\"14\">{name}</text>\
             <rect x=\"{}\" y=\"{}\" width=\"{bar:.1}\" height=\"16\" fill=\"currentColor\" opacity=\"0.6\"/>\
             <text x=\"{:.1}\" y=\"{}\" fill=\"currentColor\" font-size=\"14\">{label}</text>",
            y + 18,
            left + 8,
            y + 5,
            (left + 14) as f64 + bar,
            y + 18,
        );
    }
    svg + "</svg>"
}
