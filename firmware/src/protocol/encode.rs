//! Encoding: from messages to frames.

use super::frame::{CRC, CRC_BYTES, DELIMITER, Frame, MAX_CONTENT, MAX_FRAME, Message};

/// The frame of `message`; `None` if it would be longer than [`MAX_FRAME`]. The tests show that
/// every message fits.
// Large, and called in several places: not inlined, to save flash.
#[inline(never)]
pub fn encode<M: Message>(message: &M) -> Option<Frame> {
    let mut content = [0; MAX_CONTENT];
    let (sender, rest) = content.split_first_mut()?;
    *sender = M::SENDER as u8;
    let checked = 1 + postcard::to_slice(message, rest).ok()?.len();
    seal(&mut content, checked)
}

/// The frame of the content that is in the first bytes, so many, with its checksum. The same for all messages.
#[inline(never)]
fn seal(content: &mut [u8; MAX_CONTENT], checked: usize) -> Option<Frame> {
    let crc = CRC.checksum(content.get(..checked)?).to_le_bytes();
    let whole = checked + CRC_BYTES;
    content.get_mut(checked..whole)?.copy_from_slice(&crc);

    let mut frame = Frame::new();
    frame.resize(MAX_FRAME, DELIMITER).ok()?;
    let stuffed = cobs::try_encode(content.get(..whole)?, frame.get_mut(1..)?).ok()?;
    frame.truncate(1 + stuffed);
    frame.push(DELIMITER).ok()?;
    Some(frame)
}
