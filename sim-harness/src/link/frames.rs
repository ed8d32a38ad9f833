//! A stream of bytes, split into frames.

use fivebar_firmware::protocol::MAX_FRAME;

/// Collects bytes into frames, delimiters included. Bytes without a delimiter are cut at
/// the length of the longest frame.
#[derive(Debug, Default)]
pub(super) struct Frames {
    part: Vec<u8>,
}

impl Frames {
    /// The frame that ends with this byte, if one does.
    pub(super) fn feed(&mut self, byte: u8) -> Option<Vec<u8>> {
        if byte == 0 && self.part.iter().all(|&byte| byte == 0) {
            // The delimiter in front.
            self.part.clear();
            self.part.push(0);
            return None;
        }
        self.part.push(byte);
        let ends = byte == 0 || self.part.len() >= MAX_FRAME;
        ends.then(|| std::mem::take(&mut self.part))
    }
}
