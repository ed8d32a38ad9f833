//! 512 KiB of the QSPI flash for the settings, behind the 512 KiB for the program.
//!
//! The boot ROM's functions erase and program. While they do, nothing can be read from the flash; the program runs from SRAM
//! and goes on, ticks included. A sector here is 128 KiB, two of the chip's large blocks, as the settings' storage expects.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

/// From the start of the flash.
const START: u32 = 512 * 1024;
const SECTOR: usize = 128 * 1024;
const SECTORS: usize = 4;
/// Where the flash is read, past its cache.
const UNCACHED: u32 = 0x1400_0000;
/// What is programmed at once; ones change nothing.
const PAGE: usize = 256;
/// A large block, and the command that erases it.
const BLOCK: u32 = 64 * 1024;
const ERASE_BLOCK: u8 = 0xd8;
/// Where the ROM has the address of its search, and which functions are sought: for Arm, secure.
const LOOKUP: u32 = 0x16;
const SECURE: u32 = 4;

type Lookup = extern "C" fn(code: u32, flags: u32) -> u32;

/// The sectors.
pub struct SettingsFlash(());

impl SettingsFlash {
    /// All addresses.
    pub const RANGE: core::ops::Range<u32> = 0..(SECTORS * SECTOR) as u32;

    /// The flash of which nothing else writes.
    pub const fn new() -> Self {
        Self(())
    }
}

/// The address of a function of the boot ROM; none in a ROM that does not have it.
#[allow(unsafe_code)]
fn rom(code: [u8; 2]) -> Option<usize> {
    // SAFETY: the ROM holds a function's address there (RP2350 datasheet, 5.4.1).
    let address = unsafe {
        let place = (LOOKUP as *const u16).read_volatile();
        let lookup: Lookup = core::mem::transmute(usize::from(place));
        lookup(u32::from(u16::from_le_bytes(code)), SECURE)
    };
    (address != 0).then_some(address as usize)
}

/// Runs `work` with the flash in its serial mode, and lets it be read again.
fn with_serial_flash(work: impl FnOnce() -> Option<()>) -> Result<(), NorFlashErrorKind> {
    let functions = (|| Some([rom(*b"IF")?, rom(*b"EX")?, rom(*b"FC")?, rom(*b"CX")?]))();
    let [connect, leave_xip, flush, enter_xip] = functions.ok_or(NorFlashErrorKind::Other)?;
    call(connect);
    call(leave_xip);
    let done = work();
    call(flush);
    call(enter_xip);
    done.ok_or(NorFlashErrorKind::Other)
}

/// Calls a function of the ROM that takes nothing.
fn call(function: usize) {
    // SAFETY: the ROM has such a function there; the caller calls them in their order.
    #[allow(unsafe_code)]
    unsafe {
        core::mem::transmute::<usize, extern "C" fn()>(function)();
    }
}

impl ErrorType for SettingsFlash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for SettingsFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        for (index, byte) in (0..).zip(bytes) {
            let address = (UNCACHED + START + offset + index) as *const u8;
            // SAFETY: within the sectors, which are readable between operations.
            #[allow(unsafe_code)]
            unsafe {
                *byte = address.read_volatile();
            }
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        SECTORS * SECTOR
    }
}

impl NorFlash for SettingsFlash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;

    // Calls of their own: the stack's proof knows that they alone call the ROM.
    #[inline(never)]
    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        type Erase = extern "C" fn(address: u32, count: usize, block: u32, command: u8);
        check_erase(self, from, to)?;
        with_serial_flash(|| {
            // SAFETY: the ROM has such a function there; the blocks hold settings and no code.
            #[allow(unsafe_code)]
            let erase: Erase = unsafe { core::mem::transmute(rom(*b"RE")?) };
            erase(START + from, (to - from) as usize, BLOCK, ERASE_BLOCK);
            Some(())
        })
    }

    #[inline(never)]
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        type Program = extern "C" fn(address: u32, data: *const u8, count: usize);
        check_write(self, offset, bytes.len())?;
        let mut at = offset as usize;
        let mut rest = bytes;
        while !rest.is_empty() {
            let (start, place) = (at - at % PAGE, at % PAGE);
            let (now, later) = rest.split_at(rest.len().min(PAGE - place));
            let mut page = [0xff; PAGE];
            for (slot, &byte) in page.iter_mut().skip(place).zip(now) {
                *slot = byte;
            }
            with_serial_flash(|| {
                // SAFETY: the ROM has such a function there; the page is in SRAM and within the sectors.
                #[allow(unsafe_code)]
                let program: Program = unsafe { core::mem::transmute(rom(*b"RP")?) };
                program(START + start as u32, page.as_ptr(), PAGE);
                Some(())
            })?;
            (at, rest) = (at + now.len(), later);
        }
        Ok(())
    }
}

impl Default for SettingsFlash {
    fn default() -> Self {
        Self::new()
    }
}
