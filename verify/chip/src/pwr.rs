//! PWR: the voltage scale and the voltage detector.

use crate::register::Register;
use crate::violation::{Access, refuse};

/// The power controller.
#[derive(Clone, Debug)]
pub(crate) struct Pwr {
    cr: Register,
    csr: Register,
}

impl Pwr {
    pub(crate) fn new() -> Self {
        Self {
            cr: Register::new("PWR_CR", 0x4000, 0x43f3, 0xc),
            csr: Register::new("PWR_CSR", 0x4000, 0x0300, 0x400f),
        }
    }

    pub(crate) fn read(&self, offset: u32) -> u32 {
        match offset {
            0 => self.cr.value,
            4 => self.csr.value,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0 if value & 3 == 0 => self.cr.write(value),
            0 => refuse("PWR_CR", value, "sleep modes are not simulated"),
            4 => self.csr.write(value),
            _ => refuse("PWR", value, format!("no register at {offset:#x}")),
        }
    }
}
