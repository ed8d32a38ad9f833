//! Numbers from bytes.

use fivebar_kinematics::five_bar::Joint;

/// A reader of bytes; behind the end, it reads zeros.
pub(crate) struct Bytes<'b>(pub(crate) &'b [u8]);

impl Bytes<'_> {
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(crate) fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else {
            return 0;
        };
        self.0 = rest;
        first
    }

    pub(crate) fn flag(&mut self) -> bool {
        self.byte() & 1 == 1
    }

    pub(crate) fn joint(&mut self) -> Joint {
        if self.flag() {
            Joint::Joint4
        } else {
            Joint::Joint1
        }
    }

    pub(crate) fn short(&mut self) -> u16 {
        u16::from_le_bytes([self.byte(), self.byte()])
    }

    pub(crate) fn word(&mut self) -> u32 {
        u32::from(self.short()) | u32::from(self.short()) << 16
    }

    /// A number from `low` to `high`.
    pub(crate) fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * f32::from(self.short()) / 65535.0
    }

    /// Mostly a number from `low` to `high`, sometimes any `f32`: huge, tiny, NaN.
    pub(crate) fn number(&mut self, low: f32, high: f32) -> f32 {
        match self.byte() {
            0..=3 => f32::from_bits(self.word()),
            4 => 0.0,
            _ => self.within(low, high),
        }
    }

    pub(crate) fn pair(&mut self, low: f32, high: f32) -> [f32; 2] {
        [self.number(low, high), self.number(low, high)]
    }
}
