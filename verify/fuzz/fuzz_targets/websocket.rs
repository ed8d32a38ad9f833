//! What a page of the live page sends over its websocket: bytes, or text messages, one in each line.
#![no_main]

use fivebar::serve::received::{receive, text_frame};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    match bytes.split_first() {
        Some((b'#', bytes)) => receive(bytes),
        _ => {
            let lines = bytes.split(|&byte| byte == b'\n');
            receive(&lines.flat_map(text_frame).collect::<Vec<_>>())
        }
    };
});
