//! Pictures, PNG and JPEG: they are read or refused.
#![no_main]

use fivebar_files::picture::parse_picture;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Err(error) = parse_picture("picture", bytes) {
        assert!(error.to_string().contains("picture"));
    }
});
