//! The flash controller, the settings' sectors and the data cache in front of them.

use crate::defect::Defect;
use crate::register::Register;
use crate::time::{MICROSECOND, MILLISECOND, Time};
use crate::violation::{Access, refuse, refuse_read};

/// Address of the first sector whose contents may change: sector 8.
pub(crate) const START: u32 = 0x0808_0000;
/// Bytes from there to the end of the flash.
pub(crate) const SIZE: usize = 512 * 1024;
const SECTOR: usize = 128 * 1024;
const FIRST_SECTOR: u32 = 8;
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];
const OPTION_KEYS: [u32; 2] = [0x0819_2a3b, 0x4c5d_6e7f];
/// Time to program a word and to erase a sector of 128 KiB: the typical values.
const PROGRAM: Time = 16 * MICROSECOND;
/// Time to program the option bytes.
const OPTIONS: Time = 300 * MILLISECOND;
const ERASE: Time = 1000 * MILLISECOND;
/// How much longer than typical the slowest flash takes.
const SLOWEST: u64 = 2;
/// The data cache has 8 lines of 16 bytes.
const LINES: usize = 8;
const LINE: usize = 16;
const ERRORS: u32 = 0xf2;

/// What an access to the flash made of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operation {
    /// Nothing, or one that takes no time.
    None,
    /// The core and the flash are busy until this time.
    Busy(Time),
    /// The bus reports an error: a fault of the processor.
    BusError,
}

/// A change of the settings' sectors by the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashEvent {
    /// So many bytes were programmed, from this offset on.
    Program {
        /// From the beginning of the sectors [bytes].
        offset: u32,
        /// [bytes].
        size: u32,
        /// The bytes, the first one lowest.
        value: u32,
    },
    /// A sector was erased, counted from the first one.
    Erase {
        /// Its number.
        sector: u32,
    },
}

impl FlashEvent {
    /// Makes the change in these sectors. One that is not `whole` was cut short by a loss of
    /// power: some of its bits have changed, others have not.
    pub fn happen(self, sectors: &mut [u8], whole: bool) {
        match self {
            Self::Program {
                offset,
                size,
                value,
            } => {
                let bytes = value.to_le_bytes().into_iter().take(size as usize);
                for (at, byte) in (offset as usize..).zip(bytes) {
                    sectors[at] &= if whole { byte } else { byte | 0x5a };
                }
            }
            Self::Erase { sector } => {
                let start = sector as usize * SECTOR;
                for (at, byte) in sectors[start..start + SECTOR].iter_mut().enumerate() {
                    *byte |= if whole {
                        0xff
                    } else {
                        (at as u8).wrapping_mul(37)
                    };
                }
            }
        }
    }
}

/// The controller and its sectors.
#[derive(Clone, Debug)]
pub(crate) struct Flash {
    acr: Register,
    cr: Register,
    sr: Register,
    optcr: Register,
    /// The brown-out level in the option bytes themselves.
    brown_out: u32,
    keys: usize,
    option_keys: usize,
    /// Unlocking failed: the lock stays until the next reset.
    jammed: bool,
    /// How much longer than typical an erase takes.
    slowness: u64,
    defect: Option<Defect>,
    pub(crate) sectors: Vec<u8>,
    /// Cached lines, the one used last at the end: offset and contents.
    cache: Vec<(usize, [u8; LINE])>,
    pub(crate) events: Vec<FlashEvent>,
}

impl Flash {
    pub(crate) fn new(sectors: Vec<u8>) -> Self {
        Self {
            acr: Register::new("FLASH_ACR", 0, 0x1f07, 0),
            cr: Register::new("FLASH_CR", 0x8000_0000, 0x8100_037f, 1 << 16),
            sr: Register::new("FLASH_SR", 0, 0, 0x0001_00f3),
            optcr: Register::new("FLASH_OPTCR", 0x0fff_aaed, 0x0fff_ffed, 2),
            brown_out: 3,
            keys: 0,
            option_keys: 0,
            jammed: false,
            slowness: 1,
            defect: None,
            sectors,
            cache: Vec::new(),
            events: Vec::new(),
        }
    }

    pub(crate) fn with_defect(sectors: Vec<u8>, defect: Option<Defect>) -> Self {
        Self {
            defect,
            slowness: if defect == Some(Defect::WornFlash) {
                3
            } else {
                1
            },
            ..Self::new(sectors)
        }
    }

    /// An erase takes the longest time that the data sheet gives.
    pub(crate) fn slow_down(&mut self) {
        self.slowness = SLOWEST;
    }

    pub(crate) fn reset(&mut self) {
        let sectors = std::mem::take(&mut self.sectors);
        let events = std::mem::take(&mut self.events);
        let (slowness, defect) = (self.slowness, self.defect);
        let (optcr, brown_out) = (self.optcr.value, self.brown_out);
        *self = Self::new(sectors);
        self.events = events;
        (self.slowness, self.defect) = (slowness, defect);
        self.brown_out = brown_out;
        self.optcr.value = optcr & !0xc | brown_out << 2 | 1;
    }

    pub(crate) fn wait_states(&self) -> u32 {
        self.acr.field(0, 3)
    }

    /// Brown-out level of the option bytes: 3 is off, 0 is the highest, 2.7 V.
    pub(crate) fn brown_out_level(&self) -> u32 {
        self.brown_out
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.cr.bit(24) && self.sr.bit(0)
    }

    pub(crate) fn read(&self, offset: u32) -> u32 {
        match offset {
            0x00 => self.acr.value,
            0x0c => self.sr.value,
            0x10 => self.cr.value,
            0x14 => self.optcr.value,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> Access<Operation> {
        match offset {
            0x00 => {
                let (caching, reset) = (value >> 10 & 1, value >> 12 & 1);
                if reset != 0 && caching != 0 {
                    return refuse(
                        "FLASH_ACR",
                        value,
                        "the data cache is reset while it is enabled",
                    );
                }
                if value >> 11 & 1 != 0 && value >> 9 & 1 != 0 {
                    return refuse(
                        "FLASH_ACR",
                        value,
                        "the code cache is reset while it is enabled",
                    );
                }
                self.acr.write(value)?;
                if self.defect == Some(Defect::NoAccelerator) {
                    self.acr.clear(0x700);
                }
                if reset != 0 || caching == 0 {
                    self.cache.clear();
                }
            }
            0x04 => return Ok(self.write_key(value)),
            0x08 => {
                self.option_keys = match (self.option_keys, value) {
                    (0, key) if key == OPTION_KEYS[0] => 1,
                    (1, key) if key == OPTION_KEYS[1] => 2,
                    _ => return refuse("FLASH_OPTKEYR", value, "not the key that is next"),
                };
                if self.option_keys == 2 {
                    self.optcr.set(0, false);
                    self.option_keys = 0;
                }
            }
            0x0c => {
                self.sr.write(value)?;
                self.sr.clear(value & (ERRORS | 1));
            }
            0x10 => return self.write_cr(value, now),
            0x14 => {
                if self.optcr.bit(0) {
                    return refuse("FLASH_OPTCR", value, "the register is locked");
                }
                self.optcr.write(value)?;
                if value >> 1 & 1 != 0 {
                    if self.defect != Some(Defect::FixedOptionBytes) {
                        self.brown_out = self.optcr.field(2, 2);
                    }
                    return Ok(Operation::Busy(now + OPTIONS));
                }
            }
            _ => return refuse("FLASH", value, format!("no register at {offset:#x} here")),
        }
        Ok(Operation::None)
    }

    fn write_key(&mut self, value: u32) -> Operation {
        if self.jammed || !self.cr.bit(31) || value != KEYS[self.keys] {
            // A wrong sequence locks the register until the next reset. The keys of an
            // unlocked register are a wrong sequence, too.
            self.jammed = true;
            self.cr.set(31, true);
            return Operation::BusError;
        }
        self.keys += 1;
        if self.keys == KEYS.len() {
            self.keys = 0;
            self.cr.set(31, false);
        }
        Operation::None
    }

    fn write_cr(&mut self, value: u32, now: Time) -> Access<Operation> {
        if self.cr.bit(31) {
            return refuse("FLASH_CR", value, "the register is locked");
        }
        let starts = value >> 16 & 1 != 0;
        if value >> 31 != 0 && value & 0x0001_0007 != 0 {
            return refuse(
                "FLASH_CR",
                value,
                "an operation is set up in the write that locks",
            );
        }
        self.cr.write(value)?;
        if !starts {
            return Ok(Operation::None);
        }
        if !self.cr.bit(1) || self.cr.bit(2) || self.cr.bit(0) {
            return refuse("FLASH_CR", value, "STRT without SER alone");
        }
        self.erase(value, now)
    }

    fn erase(&mut self, value: u32, now: Time) -> Access<Operation> {
        let number = self.cr.field(3, 4);
        let Some(sector) = number
            .checked_sub(FIRST_SECTOR)
            .filter(|&sector| sector < 4)
        else {
            return refuse(
                "FLASH_CR",
                value,
                format!("sector {number} holds the program"),
            );
        };
        if self.is_protected(sector) {
            return Ok(Operation::None);
        }
        let event = FlashEvent::Erase { sector };
        event.happen(&mut self.sectors, true);
        self.events.push(event);
        self.finish();
        // With 8 or 16 bits at a time it takes two or one and a half times as long.
        let slower = [4, 3, 2, 2][self.cr.field(8, 2) as usize];
        Ok(Operation::Busy(now + ERASE * self.slowness * slower / 2))
    }

    /// Protects the sectors of these bits, and no others, from being written, as the option bytes
    /// do.
    pub(crate) fn protect(&mut self, sectors: u32) {
        self.optcr.value = self.optcr.value & !0x0fff_0000 | (!sectors & 0xfff) << 16;
    }

    /// Whether this sector, counted from the first one of the settings, is protected; notes the
    /// error.
    fn is_protected(&mut self, sector: u32) -> bool {
        let protected = !self.optcr.bit(16 + FIRST_SECTOR + sector);
        if protected {
            self.sr.set(4, true);
        }
        protected
    }

    fn finish(&mut self) {
        if self.cr.bit(24) {
            self.sr.set(0, true);
        }
    }

    /// The program writes to the sectors.
    pub(crate) fn program(
        &mut self,
        offset: u32,
        size: u32,
        value: u32,
        now: Time,
    ) -> Access<Operation> {
        let name = format!("flash at {:#x}", START + offset);
        if !self.cr.bit(0) || self.cr.bit(31) {
            self.sr.set(7, true);
            return refuse(&name, value, "PG is not set, or the controller is locked");
        }
        if self.sr.value & ERRORS != 0 {
            return refuse(&name, value, "an error flag of FLASH_SR is set");
        }
        if 1 << self.cr.field(8, 2) != size || !offset.is_multiple_of(size) {
            self.sr.set(6, true);
            return refuse(&name, value, "PSIZE differs from the size of the access");
        }
        if self.is_protected(offset / SECTOR as u32) {
            return Ok(Operation::None);
        }
        let event = FlashEvent::Program {
            offset,
            size,
            value,
        };
        event.happen(&mut self.sectors, true);
        self.events.push(event);
        // A program operation changes the cached copy, too.
        for at in (offset as usize..).take(size as usize) {
            for (line, bytes) in &mut self.cache {
                if *line == at / LINE {
                    bytes[at % LINE] &= self.sectors[at];
                }
            }
        }
        self.finish();
        Ok(Operation::Busy(now + PROGRAM))
    }

    /// The program reads the sectors, through the data cache if it is enabled.
    pub(crate) fn load(&mut self, offset: u32, size: u32) -> Access<u32> {
        let mut value = 0;
        for index in (0..size).rev() {
            let at = (offset + index) as usize;
            let byte = self.load_byte(at);
            if byte != self.sectors[at] {
                let place = format!("flash at {:#x}", START + offset);
                return refuse_read(
                    &place,
                    "the data cache holds what was there before an erase",
                );
            }
            value = value << 8 | u32::from(byte);
        }
        Ok(value)
    }

    fn load_byte(&mut self, at: usize) -> u8 {
        if !self.acr.bit(10) {
            return self.sectors[at];
        }
        let line = at / LINE;
        let cached = match self.cache.iter().position(|&(cached, _)| cached == line) {
            Some(place) => self.cache.remove(place),
            None => {
                let mut bytes = [0; LINE];
                bytes.copy_from_slice(&self.sectors[line * LINE..][..LINE]);
                if self.cache.len() == LINES {
                    self.cache.remove(0);
                }
                (line, bytes)
            }
        };
        self.cache.push(cached);
        cached.1[at % LINE]
    }
}
