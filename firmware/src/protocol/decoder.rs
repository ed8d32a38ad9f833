//! Decoding: from bytes to messages, one byte at a time.

use super::frame::{CRC, CRC_BYTES, DELIMITER, FrameError, MAX_CONTENT, Message};
use cobs::{DecodeResult, DecoderState};
use core::marker::PhantomData;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// What a link has received since it began. The counts saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkCounts {
    /// Frames with a valid message.
    pub received: u32,
    /// Frames dropped because they were damaged: stuffing, length or checksum.
    pub corrupt: u32,
    /// Undamaged frames dropped for their content: the wrong sender or version.
    pub foreign: u32,
}

/// Reads messages `M` from a stream of bytes. Frames without a valid message are dropped and
/// counted; reading goes on at the next delimiter.
///
/// ```
/// use fivebar_firmware::protocol::{Decoder, HostCommand, HostMessage, Sequence, encode};
///
/// let message = HostMessage { sequence: Sequence(7), command: HostCommand::Status };
/// let mut bytes = encode(&message).ok_or("too long")?;
/// let mut decoder = Decoder::<HostMessage>::new();
/// let received: Vec<_> = bytes.iter().filter_map(|&byte| decoder.feed(byte)).collect();
/// assert_eq!(received, [Ok(message)]);
///
/// // A damaged frame is dropped and counted.
/// bytes[3] ^= 0x10;
/// assert!(bytes.iter().filter_map(|&byte| decoder.feed(byte)).all(|frame| frame.is_err()));
/// assert_eq!(decoder.counts().received, 1);
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug)]
pub struct Decoder<M> {
    stuffing: DecoderState,
    content: Vec<u8, MAX_CONTENT>,
    /// Why the present frame is already known to be invalid.
    lost: Option<FrameError>,
    counts: LinkCounts,
    message: PhantomData<fn() -> M>,
}

impl<M: Message> Default for Decoder<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: Message> Decoder<M> {
    /// A decoder that has read nothing.
    pub const fn new() -> Self {
        Self {
            stuffing: DecoderState::Idle,
            content: Vec::new(),
            lost: None,
            counts: LinkCounts {
                received: 0,
                corrupt: 0,
                foreign: 0,
            },
            message: PhantomData,
        }
    }

    /// What has been received so far.
    pub fn counts(&self) -> LinkCounts {
        self.counts
    }

    /// Takes the next byte. `Some` at the end of each frame: its message, or why it is invalid.
    /// The work is bounded by the length of one frame.
    pub fn feed(&mut self, byte: u8) -> Option<Result<M, FrameError>> {
        self.feed_as(byte)
    }

    /// As [`Decoder::feed`], where a frame that ends now holds a message of another type.
    pub fn feed_as<T: Message>(&mut self, byte: u8) -> Option<Result<T, FrameError>> {
        if self.lost.is_none() {
            match self.stuffing.feed(byte) {
                Ok(DecodeResult::NoData) => return None,
                Ok(DecodeResult::DataStart) => {
                    self.content.clear();
                    return None;
                }
                Ok(DecodeResult::DataContinue(data)) => {
                    if self.content.push(data).is_err() {
                        self.lost = Some(FrameError::TooLong);
                    }
                    return None;
                }
                Ok(DecodeResult::DataComplete) => {}
                Err(_) => self.lost = Some(FrameError::Stuffing),
            }
        }
        if byte != DELIMITER {
            return None;
        }
        self.stuffing = DecoderState::Idle;
        let outcome = match self.lost.take() {
            Some(error) => Err(error),
            None => read(&self.content),
        };
        self.count(outcome.as_ref().err());
        Some(outcome)
    }

    fn count(&mut self, error: Option<&FrameError>) {
        let count = match error {
            None => &mut self.counts.received,
            Some(
                FrameError::Stuffing
                | FrameError::TooLong
                | FrameError::TooShort
                | FrameError::Checksum,
            ) => &mut self.counts.corrupt,
            Some(FrameError::Sender | FrameError::Malformed) => &mut self.counts.foreign,
        };
        *count = count.saturating_add(1);
    }
}

/// The message of an unstuffed frame.
// In the receiver's interrupt: the bound of its time counts the rounds of the checksum over all frames of a call.
#[inline(always)]
fn read<M: Message>(content: &[u8]) -> Result<M, FrameError> {
    let (checked, crc) = content
        .split_last_chunk::<CRC_BYTES>()
        .ok_or(FrameError::TooShort)?;
    let (&sender, message) = checked.split_first().ok_or(FrameError::TooShort)?;
    if CRC.checksum(checked) != u32::from_le_bytes(*crc) {
        return Err(FrameError::Checksum);
    }
    if sender != M::SENDER as u8 {
        return Err(FrameError::Sender);
    }
    match postcard::take_from_bytes(message) {
        Ok((message, [])) => Ok(message),
        _ => Err(FrameError::Malformed),
    }
}
