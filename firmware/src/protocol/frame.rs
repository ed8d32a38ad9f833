//! The frame: `00 ‖ COBS(sender ‖ message ‖ CRC-32C) ‖ 00`.
//!
//! Consistent overhead byte stuffing keeps zero out of the content, so a zero is always
//! the border of a frame. A frame carries a border at both ends: whatever garbage came
//! before it ends at its first zero, and no garbage can swallow it.

use crc::{CRC_32_ISCSI, Crc, NoTable};
use heapless::Vec;

/// Most bytes between the borders before stuffing: sender, message and checksum. Below 254
/// they fit one block of COBS, so the stuffing costs exactly one byte.
pub const MAX_CONTENT: usize = 253;

/// Most bytes of a frame on the wire: two borders, one stuffing byte, the content.
pub const MAX_FRAME: usize = MAX_CONTENT + 3;

/// The border of frames.
pub(super) const BORDER: u8 = 0;

/// Bytes of the checksum.
pub(super) const CRC_BYTES: usize = 4;

/// A frame as it goes over the wire.
pub type Frame = Vec<u8, MAX_FRAME>;

/// CRC-32C (Castagnoli), stored least significant byte first. Up to 655 bytes it detects
/// every pattern of up to five wrong bits (Koopman 2002, HD = 6); content has 253.
/// Eight shifts a byte rather than a table: 1 KiB of flash is worth more here than the
/// microseconds.
pub(super) static CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISCSI);

/// Who wrote a frame. It is the content's first byte, so that an echoing wire or two
/// hosts joined by mistake are told apart from a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Sender {
    /// A desktop: `H`.
    Host = b'H',
    /// A controller: `C`.
    Controller = b'C',
}

/// What one end says in one frame.
pub trait Message: serde::Serialize + serde::de::DeserializeOwned {
    /// The end that says it.
    const SENDER: Sender;
}

/// Why bytes between two borders are not a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// The stuffing is broken: a byte was lost, added or changed.
    Stuffing,
    /// More content than [`MAX_CONTENT`]: a border was lost.
    TooLong,
    /// Less than a sender, a byte of message and a checksum.
    TooShort,
    /// The checksum does not fit the content.
    Checksum,
    /// A whole frame, but of the reader's own end: the wire echoes.
    Sender,
    /// A whole frame that is no message of this version.
    Malformed,
}

impl core::fmt::Display for FrameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Stuffing => "the byte stuffing is broken",
            Self::TooLong => "the frame is longer than the protocol allows",
            Self::TooShort => "the frame is too short to hold a message",
            Self::Checksum => "the checksum does not fit the content",
            Self::Sender => "the frame comes from the reader's own end: the wire echoes",
            Self::Malformed => "the content is no message of this protocol version",
        })
    }
}

impl core::error::Error for FrameError {}
