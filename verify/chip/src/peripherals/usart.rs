//! USART1, with the baud rate of the real clock tree.

use crate::register::Register;
use crate::time::{NEVER, SECOND, Time};
use crate::violation::{Access, refuse};
use std::collections::VecDeque;

/// Two ends of a line understand each other within this relative difference of their rates.
const TOLERANCE: f64 = 0.03;
/// Start bit, 8 data bits, stop bit.
const BITS: u64 = 10;

/// The interface and the line at both of its pins.
#[derive(Clone, Debug)]
pub(crate) struct Usart {
    sr: Register,
    brr: Register,
    cr1: Register,
    cr2: Register,
    cr3: Register,
    gtpr: Register,
    received: u8,
    /// SR was read while it showed IDLE or an error: reading DR clears them.
    status_read: bool,
    /// A byte that waits for the shift register, and the one in it.
    waiting: Option<u8>,
    shifting: Option<u8>,
    shifted_at: Time,
    /// Bytes that the host sends, and when the one on the line is complete.
    incoming: VecDeque<u8>,
    arrives_at: Time,
    idle_at: Time,
    /// Bytes that the host has received.
    pub(crate) outgoing: VecDeque<u8>,
    /// Bit time of the host.
    host_bit: Time,
    /// Bit time here; zero while the interface has none.
    bit: Time,
}

const ORE: u32 = 3;
const FE: u32 = 1;
const IDLE: u32 = 4;
const RXNE: u32 = 5;
const TC: u32 = 6;
const TXE: u32 = 7;

impl Usart {
    pub(crate) fn new(host_baud: u64) -> Self {
        Self {
            sr: Register::new("USART1_SR", 0xc0, 0, 0x3ff),
            brr: Register::new("USART1_BRR", 0, 0xffff, 0),
            cr1: Register::new("USART1_CR1", 0, 0xbfff, 0),
            cr2: Register::new("USART1_CR2", 0, 0x7f6f, 0),
            cr3: Register::new("USART1_CR3", 0, 0xfff, 0),
            gtpr: Register::new("USART1_GTPR", 0, 0xffff, 0),
            received: 0,
            status_read: false,
            waiting: None,
            shifting: None,
            shifted_at: NEVER,
            incoming: VecDeque::new(),
            arrives_at: NEVER,
            idle_at: NEVER,
            outgoing: VecDeque::new(),
            host_bit: SECOND / host_baud,
            bit: 0,
        }
    }

    pub(crate) fn reset(&mut self) {
        let (incoming, outgoing) = (
            std::mem::take(&mut self.incoming),
            std::mem::take(&mut self.outgoing),
        );
        let (host_bit, arrives_at) = (self.host_bit, self.arrives_at);
        *self = Self::new(1);
        (self.incoming, self.outgoing) = (incoming, outgoing);
        (self.host_bit, self.arrives_at) = (host_bit, arrives_at);
    }

    fn enabled(&self) -> bool {
        self.cr1.bit(13)
    }

    /// The bus clock's period changed, or the divider.
    pub(crate) fn set_clock(&mut self, bus: Time) {
        let divider = if self.cr1.bit(15) {
            // Eight samples a bit: the lowest 3 bits count eighths.
            u64::from(self.brr.value & !0xf) + 2 * u64::from(self.brr.value & 7)
        } else {
            self.brr.value.into()
        };
        let samples = if self.cr1.bit(15) { 2 } else { 1 };
        self.bit = divider * bus / samples;
    }

    fn is_understood(&self) -> bool {
        let (here, there) = (self.bit as f64, self.host_bit as f64);
        (here / there - 1.0).abs() < TOLERANCE
    }

    /// The host sends bytes.
    pub(crate) fn send_to_chip(&mut self, bytes: &[u8], now: Time) {
        self.incoming.extend(bytes);
        if self.arrives_at == NEVER && !self.incoming.is_empty() {
            self.arrives_at = now + BITS * self.host_bit;
            self.idle_at = NEVER;
        }
    }

    pub(crate) fn due(&self) -> Time {
        self.shifted_at.min(self.arrives_at).min(self.idle_at)
    }

    /// Bytes that arrive and leave. `connected` tells whether the pins are the interface's:
    /// out, in.
    pub(crate) fn advance(&mut self, now: Time, connected: [bool; 2]) {
        if self.shifted_at <= now {
            self.shifted_at = NEVER;
            let byte = self.shifting.take();
            if connected[0] {
                let garbled = if self.is_understood() { 0 } else { 0xa5 };
                self.outgoing.extend(byte.map(|byte| byte ^ garbled));
            }
            self.load_shift(now);
        }
        if self.arrives_at <= now {
            let byte = self.incoming.pop_front();
            self.arrives_at = if self.incoming.is_empty() {
                self.idle_at = now + BITS * self.bit.max(1);
                NEVER
            } else {
                now + BITS * self.host_bit
            };
            if let Some(byte) = byte
                && connected[1]
                && self.enabled()
                && self.cr1.bit(2)
            {
                self.take(byte);
            }
        }
        if self.idle_at <= now {
            self.idle_at = NEVER;
            if self.enabled() && self.cr1.bit(2) && connected[1] {
                self.sr.set(IDLE, true);
            }
        }
    }

    fn take(&mut self, byte: u8) {
        let understood = self.is_understood();
        if !understood {
            self.sr.set(FE, true);
        }
        if self.sr.bit(RXNE) {
            self.sr.set(ORE, true);
            return;
        }
        self.received = if understood { byte } else { byte ^ 0x5a };
        self.sr.set(RXNE, true);
    }

    fn load_shift(&mut self, now: Time) {
        match self.waiting.take() {
            Some(byte) => {
                self.shifting = Some(byte);
                self.shifted_at = now + BITS * self.bit;
                self.sr.set(TXE, true);
            }
            None => self.sr.set(TC, true),
        }
    }

    pub(crate) fn is_sending(&self) -> bool {
        self.shifting.is_some()
    }

    /// The byte in the shift register takes so much longer.
    pub(crate) fn prolong(&mut self, time: Time) {
        if self.is_sending() {
            self.shifted_at += time;
        }
    }

    /// Whether the receiver asks the DMA.
    pub(crate) fn asks_to_store(&self) -> bool {
        self.sr.bit(RXNE) && self.cr3.bit(6)
    }

    /// Whether the sender asks the DMA.
    pub(crate) fn asks_to_load(&self) -> bool {
        self.sr.bit(TXE) && self.cr3.bit(7) && self.enabled() && self.cr1.bit(3)
    }

    pub(crate) fn interrupt(&self) -> bool {
        let on = |flag, enable| self.sr.bit(flag) && self.cr1.bit(enable);
        on(IDLE, 4) || on(RXNE, 5) || on(ORE, 5) || on(TC, 6) || on(TXE, 7)
    }

    /// Reads the data register, as the program or the DMA does.
    pub(crate) fn take_data(&mut self) -> u8 {
        self.sr.set(RXNE, false);
        if self.status_read {
            self.sr.clear(1 << IDLE | 0xf);
            self.status_read = false;
        }
        self.received
    }

    /// Writes the data register, as the program or the DMA does.
    pub(crate) fn put_data(&mut self, byte: u8, now: Time) -> Access<()> {
        if !self.enabled() || !self.cr1.bit(3) {
            return refuse("USART1_DR", byte.into(), "the sender is off");
        }
        if !self.sr.bit(TXE) {
            return refuse(
                "USART1_DR",
                byte.into(),
                "the byte before has not left: TXE is clear",
            );
        }
        self.sr.clear(1 << TXE | 1 << TC);
        self.waiting = Some(byte);
        if self.shifting.is_none() {
            self.load_shift(now);
        }
        Ok(())
    }

    pub(crate) fn read(&mut self, offset: u32) -> u32 {
        match offset {
            0x00 => {
                self.status_read = true;
                self.sr.value
            }
            0x04 => self.take_data().into(),
            0x08 => self.brr.value,
            0x0c => self.cr1.value,
            0x10 => self.cr2.value,
            0x14 => self.cr3.value,
            0x18 => self.gtpr.value,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> Access<()> {
        match offset {
            0x00 => {
                self.sr.write(value)?;
                self.sr.value &= value | !(1 << RXNE | 1 << TC | 0x300);
                Ok(())
            }
            0x04 => self.put_data(value as u8, now),
            0x08 => self.brr.write(value),
            0x0c => {
                if value >> 13 & 1 != 0 && self.brr.value < 16 {
                    return refuse("USART1_CR1", value, "enabled without a divider");
                }
                if value & (1 << 12 | 1 << 10) != 0 {
                    return refuse("USART1_CR1", value, "9 bits and parity are not simulated");
                }
                self.cr1.write(value)
            }
            0x10 => self.cr2.write(value),
            0x14 => self.cr3.write(value),
            0x18 => self.gtpr.write(value),
            _ => refuse("USART1", value, format!("no register at {offset:#x}")),
        }
    }
}
