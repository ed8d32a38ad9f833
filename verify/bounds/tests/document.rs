//! The document states the committed figures.

use fivebar_bounds::document::{table, table_in};
use fivebar_bounds::{registers, report};

#[test]
fn the_document_has_the_table_that_is_printed() {
    let printed = table(
        include_str!("../../chip/figures.txt"),
        include_str!("../../../tests/data/instructions.txt"),
        include_str!("../../chip/accesses.txt"),
    );
    assert_eq!(
        table_in(include_str!("../../../docs/verify/bounds.md")),
        printed.as_deref(),
        "print it with: cargo run --package fivebar-bounds -- document"
    );
}

#[test]
fn the_budgets_hold_with_the_registers_that_wait() {
    let (_, rows) = report::read(include_str!("../figures.txt"));
    let counted = registers::counted(include_str!("../../chip/accesses.txt"));
    for waits in counted.expect("the counts of each image") {
        let bounds = waits.bounds(&rows).expect("the bounds of each image");
        for (bound, limit) in bounds {
            let image = waits.driving.label;
            assert!(bound <= limit, "{image}: {bound} cycles of {limit}");
        }
    }
}
