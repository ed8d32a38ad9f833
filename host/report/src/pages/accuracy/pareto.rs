//! Contributions as horizontal bars.

use crate::html::{Bar, bars};

/// One bar for each name and share, in the given order.
pub(super) fn pareto(shares: &[(&str, f64)]) -> String {
    let bar = |&(name, share)| Bar {
        name,
        share,
        label: format!("{:.1} %", 100.0 * share),
    };
    bars(&shares.iter().map(bar).collect::<Vec<_>>())
}
