//! Arbitrary bytes in both halves of the settings' flash: a board starts with settings that were
//! stored, or says that they are damaged, and settings that are then stored are read again.
#![no_main]

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use fivebar_firmware::Settings;
use fivebar_firmware::storage::{SettingsStorage, StorageError};
use libfuzzer_sys::fuzz_target;

const SECTOR: usize = 2048;
const SIZE: usize = 4 * SECTOR;

/// Flash in memory. Like real flash, it clears bits when it is written.
struct Nor(Vec<u8>);

impl ErrorType for Nor {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Nor {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        let offset = offset as usize;
        bytes.copy_from_slice(&self.0[offset..offset + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl NorFlash for Nor {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        for (cell, byte) in self.0[offset as usize..].iter_mut().zip(bytes) {
            *cell &= byte;
        }
        Ok(())
    }

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        self.0[from as usize..to as usize].fill(0xff);
        Ok(())
    }
}

/// The flash after two saves, which the bytes then damage; or bytes alone.
fn flash(bytes: &[u8]) -> Nor {
    let (&how, bytes) = bytes.split_first().unwrap_or((&0, &[]));
    let mut nor = Nor(vec![0xff; SIZE]);
    if how & 1 == 0 {
        for (cell, byte) in nor.0.iter_mut().zip(bytes) {
            *cell = *byte;
        }
        return nor;
    }
    let mut storage = SettingsStorage::new(&mut nor, 0..SIZE as u32).expect("four sectors");
    for save in 0..1 + how / 2 % 8 {
        let mut settings = Settings::BENCHTOP;
        settings.payload = 0.01 + f32::from(save) * 0.001;
        storage.save(&settings).expect("sound flash");
    }
    // Each change: two bytes of the place, one byte of the bits.
    for change in bytes.chunks_exact(3) {
        let place = usize::from(u16::from_le_bytes([change[0], change[1]])) % SIZE;
        nor.0[place] ^= change[2];
    }
    nor
}

fuzz_target!(|bytes: &[u8]| {
    let mut nor = flash(bytes);
    let mut storage = SettingsStorage::new(&mut nor, 0..SIZE as u32).expect("four sectors");
    match storage.load() {
        // What the board does next. It refuses settings that are not valid.
        Ok(settings) => drop(settings.check()),
        Err(StorageError::Blank | StorageError::Corrupt) => {}
        Err(error) => panic!("{error}"),
    }
    let mut settings = Settings::BENCHTOP;
    settings.payload = 0.123;
    if storage.save(&settings).is_ok() {
        assert_eq!(storage.load(), Ok(settings));
    }
});
