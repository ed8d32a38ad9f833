//! GPIO ports A to I.

use crate::register::Register;
use crate::violation::{Access, refuse};

/// A pin: its port, 0 for A, and its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Pin(pub u8, pub u8);

/// What a pin is configured as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    Input,
    Output,
    Alternate(u32),
    Analog,
}

/// One port.
#[derive(Clone, Debug)]
pub(crate) struct Port {
    moder: Register,
    otyper: Register,
    ospeedr: Register,
    pupdr: Register,
    odr: Register,
    afr: [Register; 2],
}

impl Port {
    pub(crate) fn new(port: usize) -> Self {
        let moder = [0xa800_0000, 0x280].get(port).copied().unwrap_or(0);
        let ospeedr = if port == 1 { 0xc0 } else { 0 };
        let pupdr = [0x6400_0000, 0x100].get(port).copied().unwrap_or(0);
        Self {
            moder: Register::new("GPIO_MODER", moder, !0, 0),
            otyper: Register::new("GPIO_OTYPER", 0, 0xffff, 0),
            ospeedr: Register::new("GPIO_OSPEEDR", ospeedr, !0, 0),
            pupdr: Register::new("GPIO_PUPDR", pupdr, !0, 0),
            odr: Register::new("GPIO_ODR", 0, 0xffff, 0),
            afr: [
                Register::new("GPIO_AFRL", 0, !0, 0),
                Register::new("GPIO_AFRH", 0, !0, 0),
            ],
        }
    }

    pub(crate) fn mode(&self, pin: u8) -> Mode {
        let pin = u32::from(pin);
        match self.moder.field(2 * pin, 2) {
            0 => Mode::Input,
            1 => Mode::Output,
            2 => Mode::Alternate(self.afr[pin as usize / 8].field(4 * (pin % 8), 4)),
            _ => Mode::Analog,
        }
    }

    /// The level that the port drives; none if it does not drive the pin.
    pub(crate) fn driven(&self, pin: u8) -> Option<bool> {
        let level = self.odr.bit(pin.into());
        let open_drain = self.otyper.bit(pin.into());
        (self.mode(pin) == Mode::Output && !(open_drain && level)).then_some(level)
    }

    /// The level of the port's own resistor; none if it has none.
    pub(crate) fn pull(&self, pin: u8) -> Option<bool> {
        match self.pupdr.field(2 * u32::from(pin), 2) {
            1 => Some(true),
            2 => Some(false),
            _ => None,
        }
    }

    /// Reads a register; `levels` are the levels of the port's pins.
    pub(crate) fn read(&self, offset: u32, levels: impl FnOnce() -> u32) -> u32 {
        match offset {
            0x00 => self.moder.value,
            0x04 => self.otyper.value,
            0x08 => self.ospeedr.value,
            0x0c => self.pupdr.value,
            0x10 => levels(),
            0x14 => self.odr.value,
            0x20 => self.afr[0].value,
            0x24 => self.afr[1].value,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0x00 => self.moder.write(value),
            0x04 => self.otyper.write(value),
            0x08 => self.ospeedr.write(value),
            0x0c => {
                if (0..16).any(|pin| value >> (2 * pin) & 3 == 3) {
                    return refuse("GPIO_PUPDR", value, "the value 3 is reserved");
                }
                self.pupdr.write(value)
            }
            0x14 => self.odr.write(value),
            0x18 => {
                // Where a pin is set and reset, the setting wins.
                self.odr.value = self.odr.value & !(value >> 16) | value & 0xffff;
                Ok(())
            }
            0x20 => self.afr[0].write(value),
            0x24 => self.afr[1].write(value),
            _ => refuse(
                "GPIO",
                value,
                format!("no writable register at {offset:#x}"),
            ),
        }
    }
}
