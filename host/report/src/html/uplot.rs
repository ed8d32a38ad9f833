//! uPlot, the library that draws the charts of reports and of the live page (MIT, vendored).

/// Its script, which defines `uPlot`, after its licence, which goes with every copy.
pub const UPLOT_SCRIPT: &str = concat!(
    "/*\n",
    include_str!("uplot/LICENSE"),
    "*/\n",
    include_str!("uplot/uPlot.iife.min.js")
);

/// Its style sheet.
pub const UPLOT_STYLE: &str = include_str!("uplot/uPlot.min.css");
