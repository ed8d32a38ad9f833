//! The document states the committed figures.

use fivebar_bounds::document::{table, table_in};

#[test]
fn the_document_has_the_table_that_is_printed() {
    let printed = table(
        include_str!("../figures.txt"),
        include_str!("../../chip/figures.txt"),
        include_str!("../../../tests/data/instructions.txt"),
    );
    assert_eq!(
        table_in(include_str!("../../../docs/verify/bounds.md")),
        printed.as_deref(),
        "print it with: cargo run --package fivebar-bounds -- document"
    );
}
