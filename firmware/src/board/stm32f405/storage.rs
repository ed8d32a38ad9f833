//! The last four sectors of the flash, 128 KiB each, for the settings.
//!
//! Programming and erasing stall the core when it fetches from flash: a word for 16 µs, a sector
//! for up to 2.6 s. Settings are therefore written only while the arm is disarmed.

use crate::protocol::FlashTime;
use core::sync::atomic::{Ordering, fence};
use cortex_m::peripheral::DWT;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read,
    check_write,
};
use stm32f4xx_hal::pac::FLASH;

/// Start of sector 8.
const START: u32 = 0x0808_0000;
/// One sector.
const SECTOR: usize = 128 * 1024;
/// The number of the first sector.
const FIRST: u8 = 8;
/// Sectors: two for each half of the settings storage.
const SECTORS: usize = 4;
/// The sequence that unlocks the control register.
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];
/// How often the busy flag is read before an operation counts as failed: over 5 s.
const TIMEOUT_READS: u32 = 200_000_000;
/// No operation.
const NO_TIME: FlashTime = FlashTime {
    longest: 0,
    operations: 0,
};

/// The sectors.
pub struct SettingsFlash {
    flash: FLASH,
    time: FlashTime,
}

/// Why a sector was not read or written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FlashError {
    /// Outside the sectors, or not aligned to a word or sector.
    Address(NorFlashErrorKind),
    /// The flash did not finish in time.
    Timeout,
    /// The flash reported an error of protection, alignment or sequence.
    Refused,
}

impl core::fmt::Display for FlashError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Address(_) => "the address is outside the sectors or not aligned",
            Self::Timeout => "the flash did not finish in time",
            Self::Refused => "the flash reported an error of protection, alignment or sequence",
        })
    }
}

impl core::error::Error for FlashError {}

impl From<NorFlashErrorKind> for FlashError {
    fn from(kind: NorFlashErrorKind) -> Self {
        Self::Address(kind)
    }
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Address(kind) => *kind,
            Self::Timeout | Self::Refused => NorFlashErrorKind::Other,
        }
    }
}

impl SettingsFlash {
    /// All addresses.
    pub const RANGE: core::ops::Range<u32> = 0..(SECTORS * SECTOR) as u32;

    /// Takes the flash controller.
    pub fn new(flash: FLASH) -> Self {
        Self {
            flash,
            time: NO_TIME,
        }
    }

    /// The operations since the last call, and the longest of them.
    pub fn take_time(&mut self) -> FlashTime {
        core::mem::replace(&mut self.time, NO_TIME)
    }

    /// Runs `operation` with the control register unlocked, waits for its end and checks its
    /// status.
    fn unlocked(&mut self, operation: impl FnOnce(&FLASH)) -> Result<(), FlashError> {
        // SAFETY: the keys in this sequence unlock the register.
        #[allow(unsafe_code)]
        for key in KEYS {
            self.flash.keyr().write(|w| unsafe { w.key().bits(key) });
        }
        self.flash.sr().write(|w| {
            w.operr().clear_bit_by_one().wrperr().clear_bit_by_one();
            w.pgaerr().clear_bit_by_one().pgperr().clear_bit_by_one();
            w.pgserr().clear_bit_by_one()
        });
        let began = DWT::cycle_count();
        operation(&self.flash);
        let finished = (0..TIMEOUT_READS).any(|_| self.flash.sr().read().bsy().bit_is_clear());
        let took = DWT::cycle_count().wrapping_sub(began);
        self.time.longest = self.time.longest.max(took);
        self.time.operations = self.time.operations.saturating_add(1);
        self.flash
            .cr()
            .write(|w| w.psize().psize32().lock().set_bit());
        let status = self.flash.sr().read();
        if !finished {
            Err(FlashError::Timeout)
        } else if status.wrperr().bit_is_set()
            || status.pgaerr().bit_is_set()
            || status.pgperr().bit_is_set()
            || status.pgserr().bit_is_set()
        {
            Err(FlashError::Refused)
        } else {
            Ok(())
        }
    }
}

impl SettingsFlash {
    /// Discards what was read before an erase: the data cache does not see the erase. It may
    /// be reset only while it is disabled.
    fn empty_data_cache(&mut self) {
        self.flash.acr().modify(|_, w| w.dcen().clear_bit());
        self.flash.acr().modify(|_, w| w.dcrst().set_bit());
        self.flash
            .acr()
            .modify(|_, w| w.dcrst().clear_bit().dcen().set_bit());
    }
}

impl ErrorType for SettingsFlash {
    type Error = FlashError;
}

impl ReadNorFlash for SettingsFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        check_read(self, offset, bytes.len())?;
        let from = START + offset;
        // By words where that is possible: a board whose crystal does not serve reads 512 KiB with a tenth of its clock before
        // the watchdog bites.
        let aligned = if from.is_multiple_of(4) {
            bytes.len() / 4 * 4
        } else {
            0
        };
        let (words, rest) = bytes.split_at_mut(aligned);
        let (words, _) = words.as_chunks_mut::<4>();
        for (address, word) in (from..).step_by(4).zip(words) {
            // SAFETY: a whole word within the sectors, which are always readable.
            #[allow(unsafe_code)]
            unsafe {
                *word = (address as *const u32).read_volatile().to_ne_bytes();
            }
        }
        for (address, byte) in (from + aligned as u32..).zip(rest) {
            // SAFETY: within the sectors, which are always readable.
            #[allow(unsafe_code)]
            unsafe {
                *byte = (address as *const u8).read_volatile();
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

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        check_erase(self, from, to)?;
        let sector_of = |offset: u32| (offset / SECTOR as u32) as u8;
        for sector in sector_of(from)..sector_of(to) {
            // SAFETY: a sector of this chip, holding settings and no code.
            #[allow(unsafe_code)]
            self.unlocked(|flash| {
                // A write starts from the reset value, which holds LOCK.
                flash.cr().write(|w| unsafe {
                    w.lock()
                        .clear_bit()
                        .psize()
                        .psize32()
                        .ser()
                        .set_bit()
                        .snb()
                        .bits(FIRST + sector)
                });
                flash.cr().modify(|_, w| w.strt().set_bit());
            })?;
        }
        self.empty_data_cache();
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        check_write(self, offset, bytes.len())?;
        for (index, word) in (0..).zip(bytes.as_chunks::<4>().0) {
            let address = (START + offset + 4 * index) as *mut u32;
            let word = u32::from_le_bytes(*word);
            self.unlocked(|flash| {
                flash
                    .cr()
                    .write(|w| w.lock().clear_bit().psize().psize32().pg().set_bit());
                fence(Ordering::SeqCst);
                // SAFETY: within the sectors, aligned to a word.
                #[allow(unsafe_code)]
                unsafe {
                    address.write_volatile(word);
                }
            })?;
        }
        Ok(())
    }
}
