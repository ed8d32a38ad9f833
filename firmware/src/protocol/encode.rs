//! Messages into frames.

use super::frame::{BORDER, CRC, CRC_BYTES, Frame, MAX_CONTENT, MAX_FRAME, Message};

/// The frame of `message`; `None` if it were longer than [`MAX_FRAME`], which the tests
/// show no message to be.
// Large, and asked for wherever something is said.
#[inline(never)]
pub fn encode<M: Message>(message: &M) -> Option<Frame> {
    let mut content = [0; MAX_CONTENT];
    let (sender, rest) = content.split_first_mut()?;
    *sender = M::SENDER as u8;
    let checked = 1 + postcard::to_slice(message, rest).ok()?.len();
    let crc = CRC.checksum(content.get(..checked)?).to_le_bytes();
    let whole = checked + CRC_BYTES;
    content.get_mut(checked..whole)?.copy_from_slice(&crc);

    let mut frame = Frame::new();
    frame.resize(MAX_FRAME, BORDER).ok()?;
    let stuffed = cobs::try_encode(content.get(..whole)?, frame.get_mut(1..)?).ok()?;
    frame.truncate(1 + stuffed);
    frame.push(BORDER).ok()?;
    Some(frame)
}
