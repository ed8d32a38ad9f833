//! The frame: `00 ‖ COBS(sender ‖ message ‖ CRC-32C) ‖ 00`.
//!
//! Consistent overhead byte stuffing removes zeros from the content, so a zero is always a
//! delimiter. A frame has one at both ends: the first delimiter ends any invalid bytes that came
//! before, so that they cannot damage the frame.

use crc::{CRC_32_ISCSI, Crc, NoTable};
use heapless::Vec;

/// Most bytes between the delimiters before stuffing: sender, message and checksum. Below 254
/// they fit one block of COBS, so the stuffing costs exactly one byte.
pub const MAX_CONTENT: usize = 253;

/// Most bytes of a frame on the wire: two delimiters, one stuffing byte, the content.
pub const MAX_FRAME: usize = MAX_CONTENT + 3;

/// The delimiter of frames.
pub(super) const DELIMITER: u8 = 0;

/// Bytes of the checksum.
pub(super) const CRC_BYTES: usize = 4;

/// A frame as it goes over the wire.
pub type Frame = Vec<u8, MAX_FRAME>;

/// CRC-32C (Castagnoli), stored least significant byte first. Up to 655 bytes it detects
/// every pattern of up to five wrong bits (Koopman 2002, HD = 6); content has 253.
/// Eight shifts per byte are slower than a table and save 1 KiB of flash.
pub(super) static CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISCSI);

/// Who sent a frame: the first byte of the content. It distinguishes a controller from an echo on
/// the wire and from another host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Sender {
    /// A desktop: `H`.
    Host = b'H',
    /// A controller: `C`.
    Controller = b'C',
}

/// A message: the content of one frame.
pub trait Message: serde::Serialize + serde::de::DeserializeOwned {
    /// The end that sends it.
    const SENDER: Sender;
}

/// Why bytes between two delimiters are not a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FrameError {
    /// The stuffing is broken: a byte was lost, added or changed.
    Stuffing,
    /// More content than [`MAX_CONTENT`]: a delimiter was lost.
    TooLong,
    /// Less than a sender, a byte of message and a checksum.
    TooShort,
    /// The checksum does not fit the content.
    Checksum,
    /// An undamaged frame from the reader's own end: the wire echoes.
    Sender,
    /// An undamaged frame that holds no message of this version.
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
