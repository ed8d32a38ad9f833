//! Linkage files: read and checked, or refused with the file's name.
#![no_main]

use fivebar_files::linkage::DrivenLinkage;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    if let Err(error) = DrivenLinkage::parse("linkage.toml", &text) {
        assert!(error.to_string().starts_with("linkage.toml"));
    }
});
