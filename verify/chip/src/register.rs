//! One register and the rights of its bits.

use crate::violation::{Access, refuse};

/// A register. Bits that are neither writable nor free are reserved: they must be written
/// with their reset value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Register {
    pub(crate) value: u32,
    pub(crate) name: &'static str,
    reset: u32,
    writable: u32,
    free: u32,
}

impl Register {
    /// `writable` bits keep what is written. `free` bits are read-only or act when written:
    /// any value may be written, and the register does not keep it.
    pub(crate) const fn new(name: &'static str, reset: u32, writable: u32, free: u32) -> Self {
        Self {
            value: reset,
            name,
            reset,
            writable,
            free,
        }
    }

    pub(crate) fn write(&mut self, value: u32) -> Access<()> {
        let reserved = (value ^ self.reset) & !(self.writable | self.free);
        if reserved != 0 {
            return refuse(
                self.name,
                value,
                format!("reserved bits {reserved:#x} changed"),
            );
        }
        self.value = self.value & !self.writable | value & self.writable;
        Ok(())
    }

    pub(crate) fn bit(&self, bit: u32) -> bool {
        self.value >> bit & 1 != 0
    }

    /// The field of `width` bits from `low` on.
    pub(crate) fn field(&self, low: u32, width: u32) -> u32 {
        self.value >> low & ((1 << width) - 1)
    }

    pub(crate) fn set(&mut self, bit: u32, on: bool) {
        self.value = self.value & !(1 << bit) | u32::from(on) << bit;
    }

    pub(crate) fn clear(&mut self, bits: u32) {
        self.value &= !bits;
    }
}
