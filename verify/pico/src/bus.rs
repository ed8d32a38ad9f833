//! What the core reaches: memories, and the blocks that the image uses. An access to anything else, to a block in reset, or to a
//! register that is not modelled ends the run.

use crate::board::Blocks;
use crate::flash::{FlashEvent, Share};
use crate::image::{FLASH, FLASH_SIZE};
use rp2350_emu::core::CoreBus;
use rp2350_emu::threaded::CoreAtomics;
use std::fmt;
use std::sync::Arc;

pub(crate) const SRAM: u32 = 0x2000_0000;
const SRAM_SIZE: usize = 520 * 1024;
/// Where the flash is read past its cache.
const UNCACHED: u32 = 0x1400_0000;

/// The upper half of the addresses of the USB controller's memory.
const USB_MEMORY: u32 = 0x5010;

/// What a program may not do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Violation {
    /// What it was.
    pub what: &'static str,
    /// The address.
    pub address: u32,
    /// The instruction.
    pub pc: u32,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, address, pc } = self;
        write!(
            f,
            "{what}: {address:#010x}, by the instruction at {pc:#010x}"
        )
    }
}

impl std::error::Error for Violation {}

pub(crate) struct Bus {
    pub(crate) rom: Vec<u8>,
    pub(crate) flash: Vec<u8>,
    /// What has changed it.
    pub(crate) flash_events: Vec<FlashEvent>,
    pub(crate) sram: Vec<u8>,
    pub(crate) blocks: Blocks,
    pub(crate) violation: Option<Violation>,
    /// The flash erases or programs: nothing can be read from it.
    pub(crate) flash_is_busy: bool,
    /// Code that was written, for the core's memory of what it has decoded.
    pub(crate) written: Vec<u32>,
    pub(crate) atomics: Arc<CoreAtomics>,
    pc: u32,
    last_fetch: u32,
}

impl Bus {
    pub(crate) fn new(flash: Vec<u8>, atomics: Arc<CoreAtomics>) -> Self {
        Self {
            rom: crate::rom::bytes(),
            flash,
            flash_events: Vec::new(),
            sram: vec![0xa5; SRAM_SIZE],
            blocks: Blocks::default(),
            violation: None,
            flash_is_busy: false,
            written: Vec::new(),
            atomics,
            pc: 0,
            last_fetch: 0,
        }
    }

    pub(crate) fn violate(&mut self, what: &'static str, address: u32) {
        let pc = self.last_fetch;
        self.violation
            .get_or_insert(Violation { what, address, pc });
    }

    /// Both halves at the place of an instruction in SRAM.
    pub(crate) fn instruction(&self, address: u32) -> Option<[u16; 2]> {
        let at = address.checked_sub(SRAM)? as usize;
        let bytes = self.sram.get(at..at + 4)?;
        Some([0, 2].map(|half| u16::from_le_bytes([bytes[half], bytes[half + 1]])))
    }

    /// The bytes at an address of a memory.
    fn memory(&mut self, address: u32, size: usize) -> Option<&mut [u8]> {
        let (bytes, from) = match address {
            ..0x8000 => (&mut self.rom, 0),
            FLASH..UNCACHED => (&mut self.flash, FLASH),
            UNCACHED..0x1800_0000 => (&mut self.flash, UNCACHED),
            SRAM..0x3000_0000 => (&mut self.sram, SRAM),
            _ => return None,
        };
        let at = (address - from) as usize;
        bytes.get_mut(at..at + size)
    }

    fn read(&mut self, address: u32, size: usize) -> u32 {
        let in_flash = address >> 28 == 1;
        if in_flash && self.flash_is_busy {
            self.violate("the flash is read while it is busy", address);
        }
        if address >> 16 == USB_MEMORY {
            return self.read_usb(address, size);
        }
        if let Some(bytes) = self.memory(address, size) {
            let mut word = [0; 4];
            word[..size].copy_from_slice(bytes);
            return u32::from_le_bytes(word);
        }
        if size < 4 {
            self.violate("a register is read in part", address);
            return 0;
        }
        match self.blocks.read(address) {
            Ok(value) => value,
            Err(what) => {
                self.violate(what, address);
                0
            }
        }
    }

    fn write(&mut self, address: u32, value: u32, size: usize) {
        if address >> 28 == 2
            && let Some(bytes) = self.memory(address, size)
        {
            bytes.copy_from_slice(&value.to_le_bytes()[..size]);
            self.written.extend([address, address + 2]);
            return;
        }
        if address >> 16 == USB_MEMORY {
            self.write_usb(address, value, size);
        } else if size < 4 {
            self.violate("a register is written in part", address);
        } else if let Err(what) = self.blocks.write(address, value) {
            self.violate(what, address);
        }
    }

    fn read_usb(&mut self, address: u32, size: usize) -> u32 {
        match self.blocks.usb_memory(address, size) {
            Ok(bytes) => {
                let mut word = [0; 4];
                word[..size].copy_from_slice(bytes);
                u32::from_le_bytes(word)
            }
            Err(what) => {
                self.violate(what, address);
                0
            }
        }
    }

    fn write_usb(&mut self, address: u32, value: u32, size: usize) {
        if !(address as usize).is_multiple_of(size) {
            self.violate("a word of the USB memory is crossed", address);
        } else if size == 4 && !self.blocks.usb_takes(address, value) {
            self.violate(
                "a USB buffer is not complete when it is made available",
                address,
            );
        }
        match self.blocks.usb_memory(address, size) {
            Ok(bytes) => bytes.copy_from_slice(&value.to_le_bytes()[..size]),
            Err(what) => self.violate(what, address),
        }
    }

    /// Erases blocks of the flash.
    pub(crate) fn erase(&mut self, from: u32, count: u32) {
        let (from, count) = (from as usize, count as usize);
        let whole = from.is_multiple_of(4096) && count.is_multiple_of(4096);
        if from + count > FLASH_SIZE || !whole {
            return self.violate("no whole sectors are erased", from as u32);
        }
        self.change(FlashEvent::Erase { from, count });
    }

    /// Programs pages of the flash.
    pub(crate) fn program(&mut self, at: u32, data: u32, count: u32) {
        if !at.is_multiple_of(256) || !count.is_multiple_of(256) {
            return self.violate("no whole pages are programmed", at);
        }
        let bytes = (0..count)
            .map(|index| self.read(data + index, 1) as u8)
            .collect();
        let at = at as usize;
        self.change(FlashEvent::Program { at, bytes });
    }

    fn change(&mut self, event: FlashEvent) {
        event.happen(&mut self.flash, Share::Whole);
        self.flash_events.push(event);
    }
}

impl CoreBus for Bus {
    fn read8(&mut self, addr: u32, _: u8) -> u8 {
        self.read(addr, 1) as u8
    }

    fn read16(&mut self, addr: u32, _: u8) -> u16 {
        self.read(addr, 2) as u16
    }

    fn read32(&mut self, addr: u32, _: u8) -> u32 {
        self.read(addr, 4)
    }

    fn write8(&mut self, addr: u32, val: u8, _: u8) {
        self.write(addr, u32::from(val), 1);
    }

    fn write16(&mut self, addr: u32, val: u16, _: u8) {
        self.write(addr, u32::from(val), 2);
    }

    fn write32(&mut self, addr: u32, val: u32, _: u8) {
        self.write(addr, val, 4);
    }

    fn set_active_pc(&mut self, pc: u32, _: u8) {
        self.pc = pc;
    }

    fn bus_fault(&self, core: u8) -> bool {
        self.atomics.is_bus_fault(core.into())
    }

    fn bus_fault_addr(&self, core: u8) -> u32 {
        self.atomics.bus_fault_addr(core.into())
    }

    fn clear_bus_fault(&mut self, core: u8) {
        self.atomics.clear_bus_fault(core.into());
    }

    fn set_burst_mode(&mut self, _: bool) {}

    fn add_extra_wait_states(&mut self, _: u32) {}

    fn take_extra_wait_states(&mut self) -> u32 {
        0
    }

    fn atomics(&self) -> &Arc<CoreAtomics> {
        &self.atomics
    }

    // The image does not use the coprocessor of the pins.
    fn gpio_read_out(&self) -> u32 {
        0
    }

    fn gpio_write_out(&mut self, _: u32) {}

    fn gpio_set_out(&mut self, _: u32) {}

    fn gpio_clear_out(&mut self, _: u32) {}

    fn gpio_xor_out(&mut self, _: u32) {}

    fn gpio_read_oe(&self) -> u32 {
        0
    }

    fn gpio_write_oe(&mut self, _: u32) {}

    fn gpio_set_oe(&mut self, _: u32) {}

    fn gpio_clear_oe(&mut self, _: u32) {}

    fn gpio_xor_oe(&mut self, _: u32) {}

    fn gpio_read_in(&self) -> u32 {
        0
    }

    fn extra_wait_states(&self) -> u32 {
        0
    }

    fn reset_extra_wait_states(&mut self) {}

    fn last_fetch_addr(&self) -> u32 {
        self.last_fetch
    }

    fn set_last_fetch_addr(&mut self, addr: u32) {
        self.last_fetch = addr;
    }

    fn mmio_trace_enabled(&self) -> bool {
        false
    }

    fn emit_mmio_trace(&mut self, _: char, _: u32, _: u32, _: u32, _: u8) {}
}
