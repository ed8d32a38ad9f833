//! The settings' storage on the production image: the image treats every flash as the same code
//! in this process does, to the byte.

mod bench;

use bench::{Bench, Driven, save, settings, used_flash};
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use fivebar_chip::{FlashEvent, Options};
use fivebar_firmware::protocol::{CommandError, Reply};
use fivebar_firmware::safety::Fault;
use fivebar_firmware::storage::{SettingsStorage, StorageError};
use fivebar_firmware::{Request, Settings};

/// The size of a sector, and of all four [bytes].
const SECTOR: usize = 128 * 1024;
const SIZE: usize = 4 * SECTOR;

/// A flash in this process, with the words and sectors of the board's.
struct Memory<'a> {
    bytes: &'a mut [u8],
    erased: &'a mut u32,
}

impl ErrorType for Memory<'_> {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Memory<'_> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        let from = offset as usize;
        bytes.copy_from_slice(&self.bytes[from..from + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Memory<'_> {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        self.bytes[from as usize..to as usize].fill(0xff);
        *self.erased += 1;
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        let slots = &mut self.bytes[offset as usize..];
        for (slot, byte) in slots.iter_mut().zip(bytes) {
            *slot &= byte;
        }
        Ok(())
    }
}

/// Works on the storage in this flash; how many times a sector was erased meanwhile.
fn with_storage(bytes: &mut [u8], work: impl FnOnce(&mut SettingsStorage<Memory<'_>>)) -> u32 {
    let mut erased = 0;
    let memory = Memory {
        bytes,
        erased: &mut erased,
    };
    let mut storage = SettingsStorage::new(memory, 0..SIZE as u32).expect("a valid range");
    work(&mut storage);
    erased
}

fn save_here(bytes: &mut [u8], settings: &Settings) -> u32 {
    with_storage(bytes, |storage| storage.save(settings).expect("saved"))
}

fn boot(flash: &[u8]) -> Driven {
    Bench::with(Options::default(), flash.to_vec(), 0).connect()
}

/// A flash whose next save has to erase a half that is full.
fn about_to_erase() -> Vec<u8> {
    let mut flash = vec![0xff; SIZE];
    for _ in 0..3000 {
        let before = flash.clone();
        if save_here(&mut flash, &settings()) > 0 {
            return before;
        }
    }
    panic!("no save erases a half");
}

#[test]
fn a_half_is_erased_before_its_sector_is_full() {
    let mut flash = about_to_erase();
    let mut driven = boot(&flash);
    assert_eq!(driven.status().fault, None);
    for _ in 0..2 {
        assert_eq!(save(&mut driven), Reply::Done);
        save_here(&mut flash, &settings());
        assert!(driven.chip().settings() == flash, "the flash differs");
    }
    let events = driven.chip().flash_events();
    let is_erase = |event: &&FlashEvent| matches!(event, FlashEvent::Erase { .. });
    assert!(events.iter().filter(is_erase).count() > 0);
}

/// Damages to a sector.
const DAMAGES: [fn(&mut [u8]); 7] = [
    |sector| sector.fill(0),
    |sector| sector.fill(0xff),
    |sector| sector[..4].fill(0),
    |sector| sector[SECTOR - 4..].fill(0),
    // The item's length, its checksum, its contents.
    |sector| sector[4..8].fill(0),
    |sector| sector[8..12].fill(0),
    |sector| sector[40] &= 0x55,
];

#[test]
fn a_damaged_flash_is_read_and_repaired_as_in_this_process() {
    let mut sound = vec![0xff; SIZE];
    for number in 0_u8..5 {
        let mut other = settings();
        other.motion.singularity_margin *= 1.0 - 0.01 * f32::from(number);
        save_here(&mut sound, &other);
    }
    let cases = (0..4).flat_map(|sector| DAMAGES.iter().map(move |damage| (sector, damage)));
    for (number, (sector, damage)) in cases.enumerate() {
        let mut flash = sound.clone();
        damage(&mut flash[sector * SECTOR..][..SECTOR]);
        let mut driven = boot(&flash);
        let mut loaded = Err(StorageError::Blank);
        with_storage(&mut flash, |storage| loaded = storage.load());
        let fault = driven.status().fault;
        let mut found = settings();
        driven.client.read_settings(&mut found).expect("settings");
        match loaded {
            Ok(settings) => assert_eq!((fault, found), (None, settings), "case {number}"),
            Err(_) => assert_eq!(fault, Some(Fault::SettingsCorrupt), "case {number}"),
        }
        if fault.is_some() {
            driven.request(Request::ClearFault).expect("cleared");
        }
        let applied = driven.client.write_settings(&settings()).expect("a line");
        applied.expect("valid settings");
        assert_eq!(save(&mut driven), Reply::Done, "case {number}");
        save_here(&mut flash, &settings());
        assert!(driven.chip().settings() == flash, "case {number}");
    }
}

#[test]
fn a_flash_that_refuses_is_reported_and_keeps_its_settings() {
    let mut flash = vec![0xff; SIZE];
    save_here(&mut flash, &settings());
    // Blank sectors to write, and sectors to erase.
    let mut used = flash.clone();
    used[SIZE / 2..].copy_from_slice(&used_flash()[SIZE / 2..]);
    for flash in [flash, used] {
        let mut driven = boot(&flash);
        driven.chip().protect_sectors(0xf00);
        let refused = Reply::Refused(CommandError::Storage(StorageError::Flash));
        assert_eq!(save(&mut driven), refused);
        assert!(driven.chip().settings() == flash, "the flash differs");
        // It serves again.
        driven.chip().protect_sectors(0);
        assert_eq!(save(&mut driven), Reply::Done);
    }
}

#[test]
fn stored_settings_of_another_tick_rate_are_not_used() {
    let mut flash = vec![0xff; SIZE];
    let mut other = settings();
    other.control.tick_rate = 20_000.0;
    other.check().expect("valid on another board");
    save_here(&mut flash, &other);
    let mut driven = boot(&flash);
    assert_eq!(driven.status().fault, Some(Fault::SettingsCorrupt));
}
