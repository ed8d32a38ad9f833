//! Tables of measurements: they are read or refused, and their values are finite.
#![no_main]

use fivebar_files::measurements::parse_columns;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    match parse_columns("table.csv", bytes, ["counts1", "counts4", "x", "y"]) {
        Ok(rows) => assert!(rows.iter().flatten().all(|value| value.is_finite())),
        Err(error) => assert!(error.to_string().contains("table.csv")),
    }
});
