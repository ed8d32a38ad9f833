//! UART0: both buffers of 32 bytes, and the time that each byte takes on the line.

use std::collections::VecDeque;

/// Bytes of a buffer.
const DEPTH: usize = 32;
/// The interrupt comes with so many bytes, half of them, or when the line has been quiet for so many bits.
const LEVEL: usize = 16;
const QUIET_BITS: u64 = 32;
/// Bits of a byte on the line.
const FRAME_BITS: u64 = 10;
/// Bits of UARTIMSC: bytes have come, the line is quiet.
const RECEIVE_MASKS: u32 = 1 << 4 | 1 << 6;
const ENABLED: u32 = 1 | 1 << 8 | 1 << 9;

#[derive(Default)]
pub(crate) struct Uart {
    divider: [u32; 2],
    control: u32,
    mask: u32,
    others: [u32; 4],
    sending: VecDeque<u8>,
    received: VecDeque<u8>,
    /// Cycles until the byte on the line has left, and until the next one of the host is there.
    until_sent: u64,
    until_received: u64,
    quiet: u64,
    /// The interrupt for these bytes was raised.
    raised: bool,
    /// Bytes from and to the host.
    pub(crate) from_host: VecDeque<u8>,
    pub(crate) to_host: Vec<u8>,
    /// Bytes that found no place.
    pub(crate) overruns: u32,
}

impl Uart {
    /// Cycles of a bit.
    fn bit(&self) -> u64 {
        let [whole, parts] = self.divider.map(u64::from);
        (64 * whole + parts) * 16 / 64
    }

    pub(crate) fn read(&mut self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => u32::from(self.received.pop_front()?),
            0x18 => {
                let flag = |bit: u32, on: bool| u32::from(on) << bit;
                flag(3, !self.sending.is_empty())
                    | flag(4, self.received.is_empty())
                    | flag(5, self.sending.len() == DEPTH)
                    | flag(7, self.sending.is_empty())
            }
            0x24 => self.divider[0],
            0x28 => self.divider[1],
            0x2c => self.others[0],
            0x30 => self.control,
            0x34 => self.others[1],
            0x38 => self.mask,
            _ => return None,
        })
    }

    /// None where there is no such register, or a byte is lost.
    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Option<()> {
        match offset {
            0x00 if self.sending.len() < DEPTH => {
                if self.sending.is_empty() {
                    self.until_sent = FRAME_BITS * self.bit();
                }
                self.sending.push_back(value as u8);
            }
            0x24 => self.divider[0] = value,
            0x28 => self.divider[1] = value,
            0x2c => self.others[0] = value,
            0x30 => self.control = value,
            0x34 => self.others[1] = value,
            0x38 => self.mask = value,
            _ => return None,
        }
        Some(())
    }

    /// Lets time pass; true when the interrupt is raised.
    pub(crate) fn advance(&mut self, cycles: u64) -> bool {
        if self.control & ENABLED != ENABLED {
            return false;
        }
        let frame = FRAME_BITS * self.bit();
        if !self.sending.is_empty() {
            self.until_sent = self.until_sent.saturating_sub(cycles);
            if self.until_sent == 0 {
                self.to_host.extend(self.sending.pop_front());
                self.until_sent = frame;
            }
        }
        self.quiet += cycles;
        if !self.from_host.is_empty() {
            self.until_received = self.until_received.saturating_sub(cycles);
            if self.until_received == 0 {
                let byte = self.from_host.pop_front();
                self.until_received = frame;
                self.quiet = 0;
                self.raised = false;
                if self.received.len() == DEPTH {
                    self.overruns += 1;
                } else {
                    self.received.extend(byte);
                }
            }
        }
        let due = self.received.len() >= LEVEL
            || !self.received.is_empty() && self.quiet >= QUIET_BITS * self.bit();
        let raises = due && !self.raised && self.mask & RECEIVE_MASKS == RECEIVE_MASKS;
        self.raised |= raises;
        raises
    }
}
