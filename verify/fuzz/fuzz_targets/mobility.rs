//! Files of mechanisms, in both of their formats.
#![no_main]

use fivebar_files::mobility;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    for file in ["mechanism.toml", "cases.json"] {
        if let Err(error) = mobility::parse(file, &text) {
            assert!(error.to_string().starts_with(file));
        }
    }
});
