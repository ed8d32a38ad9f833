//! NOR flash with a power supply that fails at a chosen operation.

#![allow(dead_code, reason = "each binary uses its own part")]

use core::ops::Range;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read,
    check_write,
};

/// Bytes of a sector: smaller than those of an STM32F405, so that the log begins again soon.
pub(crate) const SECTOR: usize = 4 * 1024;
/// Two for each half.
pub(crate) const SECTORS: usize = 4;
/// Bytes programmed at once.
pub(crate) const WORD: usize = 4;

/// What the operation that the power failure interrupts leaves behind.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Cut {
    /// The operation did not begin.
    Before,
    /// It changed these bits and not the others: of a word while writing, of every word of
    /// the sector while erasing.
    Torn(u32),
    /// An erase has blanked this many words of its sector; a write is complete.
    After(usize),
}

/// As many sectors as the settings need, in memory.
#[derive(Clone)]
pub(crate) struct Nor {
    pub(crate) bytes: Vec<u8>,
    /// Words written and sectors erased so far.
    pub(crate) operations: usize,
    /// Sectors erased so far.
    pub(crate) erased: usize,
    /// The operation at which the power fails, and what it leaves behind.
    pub(crate) cut: Option<(usize, Cut)>,
    /// Bytes whose reading fails.
    pub(crate) unreadable: Range<usize>,
}

/// What went wrong.
#[derive(Debug)]
pub(crate) enum Fault {
    Dark,
    Misuse(NorFlashErrorKind),
}

impl NorFlashError for Fault {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Dark => NorFlashErrorKind::Other,
            Self::Misuse(kind) => *kind,
        }
    }
}

impl From<NorFlashErrorKind> for Fault {
    fn from(kind: NorFlashErrorKind) -> Self {
        Self::Misuse(kind)
    }
}

impl Nor {
    pub(crate) fn blank() -> Self {
        Self {
            bytes: vec![0xff; SECTORS * SECTOR],
            operations: 0,
            erased: 0,
            cut: None,
            unreadable: 0..0,
        }
    }

    /// How the operation that begins now is interrupted, if it is; all later ones fail.
    fn begin(&mut self) -> Result<Option<Cut>, Fault> {
        let now = self.operations;
        self.operations += 1;
        match self.cut {
            Some((at, _)) if now > at => Err(Fault::Dark),
            Some((at, cut)) if now == at => Ok(Some(cut)),
            _ => Ok(None),
        }
    }
}

impl ErrorType for Nor {
    type Error = Fault;
}

impl ReadNorFlash for Nor {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Fault> {
        check_read(self, offset, bytes.len())?;
        let offset = offset as usize;
        if offset < self.unreadable.end && self.unreadable.start < offset + bytes.len() {
            return Err(Fault::Dark);
        }
        bytes.copy_from_slice(&self.bytes[offset..offset + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Nor {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Fault> {
        check_write(self, offset, bytes.len())?;
        for (index, word) in bytes.chunks(WORD).enumerate() {
            let at = offset as usize + index * WORD;
            let mask = match self.begin()? {
                Some(Cut::Before) => return Err(Fault::Dark),
                Some(Cut::Torn(mask)) => mask,
                Some(Cut::After(_)) | None => u32::MAX,
            };
            // Programming can only clear bits.
            for ((cell, byte), mask) in self.bytes[at..]
                .iter_mut()
                .zip(word)
                .zip(mask.to_le_bytes())
            {
                *cell &= byte | !mask;
            }
        }
        Ok(())
    }

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Fault> {
        check_erase(self, from, to)?;
        for start in (from as usize..to as usize).step_by(SECTOR) {
            let (words, mask) = match self.begin()? {
                Some(Cut::Before) => return Err(Fault::Dark),
                Some(Cut::Torn(mask)) => (SECTOR / WORD, mask),
                Some(Cut::After(words)) => (words, u32::MAX),
                None => (SECTOR / WORD, u32::MAX),
            };
            self.erased += 1;
            let sector = &mut self.bytes[start..start + SECTOR];
            for word in sector.chunks_mut(WORD).take(words) {
                for (cell, mask) in word.iter_mut().zip(mask.to_le_bytes()) {
                    *cell |= mask;
                }
            }
        }
        Ok(())
    }
}
