//! Settings in flash survive power cuts.

use crate::nor::{self, Cut, Nor, SECTOR};
use fivebar_firmware::Settings;
use fivebar_firmware::settings::{AdvancedSettings, BeltSettings, FieldLag};
use fivebar_firmware::storage::{LAYOUT, SettingsStorage, StorageError};
use fivebar_testkit::Tally;
use proptest::prelude::*;

/// Settings that depend on a number, at their beginning, middle and end.
fn settings(number: u16) -> Settings {
    let (mut settings, _) = postcard::take_from_bytes::<Settings>(&[0; 1024]).expect("all zero");
    let value = f32::from(number);
    settings.lengths = [value; 5];
    settings.axes[0].resistance = -value;
    settings.protection.command_timeout = value + 0.5;
    settings.belts[1].observer[4] = value + 0.125;
    settings.field_lags[1].bend = value + 0.25;
    settings
}

fn storage(flash: &mut Nor) -> SettingsStorage<&mut Nor> {
    let end = u32::try_from(nor::SECTORS * SECTOR).expect("small");
    SettingsStorage::new(flash, 0..end).expect("four sectors")
}

fn load(flash: &mut Nor) -> Result<Settings, StorageError> {
    storage(flash).load()
}

fn save(flash: &mut Nor, number: u16) -> Result<(), StorageError> {
    storage(flash).save(&settings(number))
}

/// Every way in which the last operation may be interrupted.
const CUTS: [Cut; 5] = [
    Cut::Before,
    Cut::Torn(0x0000_ffff),
    Cut::Torn(0xffff_0000),
    Cut::Torn(0x5a5a_a5a5),
    Cut::After(SECTOR / nor::WORD / 2),
];

/// The flash after each of this number of saves, oldest first; the first one is blank.
fn history(saves: u16) -> Vec<Nor> {
    let mut flash = Nor::blank();
    let mut history = vec![flash.clone()];
    for number in 1..=saves {
        flash.operations = 0;
        save(&mut flash, number).expect("power is on");
        history.push(flash.clone());
    }
    history
}

/// The flash after save `number` lost power during operation `at`.
fn cut_save(before: &Nor, number: u16, at: usize, cut: Cut) -> Nor {
    let mut flash = before.clone();
    flash.operations = 0;
    flash.cut = Some((at, cut));
    let _ = save(&mut flash, number);
    flash
}

/// Asserts that the flash holds what save `number` stored or what was there before; counts
/// which of them.
#[track_caller]
fn assert_old_or_new(flash: &mut Nor, number: u16, is_new: &Tally, what: &str) {
    let found = load(flash);
    let old = match found {
        Ok(found) => number > 1 && found == settings(number - 1),
        Err(StorageError::Blank | StorageError::Corrupt) => number == 1,
        Err(_) => false,
    };
    let new = is_new.count(found == Ok(settings(number)));
    assert!(old || new, "{what}: {found:?}");
}

#[test]
fn settings_are_old_or_new_after_a_power_cut_at_every_operation() {
    // Enough to use all sectors twice.
    let history = history(60);
    // A save that changes sectors copies the settings and writes them.
    let changes_sector = |flash: &Nor| flash.operations > history[4].operations * 2;
    let changes = history.iter().filter(|flash| changes_sector(flash)).count();
    assert!(changes >= 4, "each half changes sectors twice: {changes}");
    let is_new = Tally::default();

    for (number, pair) in (1u16..).zip(history.windows(2)) {
        let (before, operations) = (&pair[0], pair[1].operations);
        // The first save of each half, those that change sectors, and those after them.
        if number > 2 && !changes_sector(&pair[1]) && !changes_sector(before) {
            continue;
        }
        for (at, cut) in (0..operations).flat_map(|at| CUTS.map(|cut| (at, cut))) {
            let mut flash = cut_save(before, number, at, cut);
            flash.cut = None;
            flash.operations = 0;
            let torn = flash.clone();
            let what = format!("save {number} cut at {at} of {operations} by {cut:?}");
            assert_old_or_new(&mut flash, number, &is_new, &what);

            // The power fails again at some operations of the repair by the first load.
            for again in (0..flash.operations).step_by(5) {
                let mut flash = torn.clone();
                flash.cut = Some((again, cut));
                let _ = load(&mut flash);
                flash.cut = None;
                let what = format!("{what}, again at {again}");
                assert_old_or_new(&mut flash, number, &is_new, &what);
            }

            save(&mut flash, 1000).expect("the storage works again");
            assert_eq!(load(&mut flash), Ok(settings(1000)), "{what}");
        }
    }
    // A save becomes valid by its last operation.
    assert!(
        is_new.accepted() >= 4 && is_new.refused() > 1000,
        "{is_new:?}"
    );
}

#[test]
fn blank_flash_and_flash_full_of_zeros_hold_no_settings() {
    assert_eq!(load(&mut Nor::blank()), Err(StorageError::Blank));
    let mut zeros = Nor::blank();
    zeros.bytes.fill(0);
    assert_eq!(load(&mut zeros), Err(StorageError::Corrupt));
    save(&mut zeros, 5).expect("a save makes it good");
    assert_eq!(load(&mut zeros), Ok(settings(5)));
}

/// The two sectors of a half at once; the log by itself erases one at a time.
#[test]
fn a_half_is_erased_as_a_whole_at_its_120th_save_and_at_no_other() {
    let mut flash = Nor::blank();
    let mut erased_whole = Vec::new();
    for number in 0..490 {
        let before = flash.erased;
        save(&mut flash, number).expect("power is on");
        if flash.erased - before == nor::SECTORS / 2 {
            erased_whole.push(number);
        }
    }
    assert_eq!(erased_whole, [238, 239, 478, 479]);
}

/// Names, order and nesting of all fields, and the number that is stored with them. Whoever changes
/// the settings gives their layout a new number, then states both here.
#[test]
fn a_change_of_the_settings_gives_their_layout_a_new_number() {
    let fields = format!("{:?}", settings(0));
    let digest = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(fields.as_bytes());
    assert_eq!((LAYOUT, digest), (12, 0x8214_c57b), "{fields}");
}

/// The flash after five saves by older firmware, of which `shown` bytes at the beginning of each half were written.
fn flash_of(shown: &[u8]) -> Nor {
    let mut flash = Nor::blank();
    let (first, second) = shown.split_at(shown.len() / 2);
    flash.bytes[..first.len()].copy_from_slice(first);
    let middle = nor::SECTORS * SECTOR / 2;
    flash.bytes[middle..middle + second.len()].copy_from_slice(second);
    flash
}

/// Settings of this number with the default of what the table of layout 11 lacks.
fn before_layout_12(number: u16) -> Settings {
    let mut settings = settings(number);
    settings.advanced.pen_friction = AdvancedSettings::DEFAULT.pen_friction;
    settings
}

/// Settings of this number without what layout 10 lacks.
fn before_layout_11(number: u16) -> Settings {
    Settings {
        field_lags: [FieldLag::NONE; 2],
        ..before_layout_12(number)
    }
}

/// Settings of this number with the default of what the table of layout 9 lacks.
fn before_layout_10(number: u16) -> Settings {
    let mut settings = before_layout_11(number);
    settings.advanced.motion_torque = AdvancedSettings::DEFAULT.motion_torque;
    settings
}

/// What older firmware saved, and what its settings of this number are now: in layout 7 without `advanced`, in
/// layout 8 with its first number, both without belts, in layouts 9 and 10 with belts, without
/// lags, and in layout 11 with two numbers, belts and lags.
type Older = (&'static [u8], fn(u16) -> Settings);

const OLDER: [Older; 5] = [
    (include_bytes!("../data/layout_7.bin"), |number| Settings {
        advanced: AdvancedSettings::DEFAULT,
        belts: [BeltSettings::RIGID; 2],
        ..before_layout_11(number)
    }),
    (include_bytes!("../data/layout_8.bin"), |number| Settings {
        belts: [BeltSettings::RIGID; 2],
        ..before_layout_10(number)
    }),
    (include_bytes!("../data/layout_9.bin"), before_layout_10),
    (include_bytes!("../data/layout_10.bin"), before_layout_11),
    (include_bytes!("../data/layout_11.bin"), before_layout_12),
];

#[test]
fn settings_of_older_firmware_are_read_with_the_defaults_of_what_they_lack() {
    for (shown, upgraded) in OLDER {
        let mut flash = flash_of(shown);
        assert_eq!(load(&mut flash), Ok(upgraded(5)));

        // The first save after the update may lose power at any operation.
        let mut saved = flash.clone();
        saved.operations = 0;
        save(&mut saved, 6).expect("power is on");
        let operations = saved.operations;
        assert_eq!(load(&mut saved), Ok(settings(6)));
        for (at, cut) in (0..operations).flat_map(|at| CUTS.map(|cut| (at, cut))) {
            let mut torn = cut_save(&flash, 6, at, cut);
            torn.cut = None;
            let found = load(&mut torn);
            let old = found == Ok(upgraded(5));
            assert!(old || found == Ok(settings(6)), "{at} {cut:?}: {found:?}");
            save(&mut torn, 7).expect("the storage works again");
            assert_eq!(load(&mut torn), Ok(settings(7)), "{at} {cut:?}");
        }
    }
}

#[test]
fn a_flash_that_fails_is_told_from_one_that_is_damaged() {
    let mut flash = Nor::blank();
    flash.cut = Some((0, Cut::Before));
    assert_eq!(save(&mut flash, 1), Err(StorageError::Flash));
}

#[test]
fn a_range_of_less_than_four_sectors_is_refused() {
    for end in [0, 1, SECTOR, 3 * SECTOR, 4 * SECTOR - 4] {
        let end = u32::try_from(end).expect("small");
        let refused = SettingsStorage::new(Nor::blank(), 0..end).err();
        assert_eq!(refused, Some(StorageError::Range), "{end}");
    }
}

#[test]
fn a_hidden_item_that_a_save_uncovers_is_not_taken_for_the_one_saved() {
    // Hides item 16, and damages the half of item 15 behind it; saving after that is number
    // 16 once more.
    let mut flash = history(16).pop().expect("16 saves");
    for (at, length, value) in [(10924, 2, 1), (7274, 919, 55)] {
        let damaged = flash.bytes.iter_mut().skip(at).take(length);
        damaged.for_each(|byte: &mut u8| *byte ^= value);
    }
    assert_eq!(load(&mut flash), Ok(settings(15)));
    save(&mut flash, 1000).expect("the storage works again");
    assert_eq!(load(&mut flash), Ok(settings(1000)));
}

#[test]
fn damage_never_makes_settings_that_were_not_saved() {
    let found = Tally::default();
    let place = (0..nor::SECTORS * SECTOR, 1usize..2000, any::<u8>());
    let damage = prop::collection::vec(place, 1..8);
    let config = ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    proptest!(config, |(saves in 1u16..60, damage in damage)| {
        let mut flash = Nor::blank();
        for number in 1..=saves {
            save(&mut flash, number).expect("power is on");
        }
        for (at, length, value) in damage {
            flash.bytes.iter_mut().skip(at).take(length).for_each(|byte| *byte ^= value);
        }
        let loaded = load(&mut flash);
        found.count(loaded.is_ok());
        match loaded {
            Ok(found) => prop_assert!((1..=saves).any(|number| found == settings(number))),
            Err(error) => prop_assert_eq!(error, StorageError::Corrupt),
        }
        save(&mut flash, 1000).expect("the storage works again");
        prop_assert_eq!(load(&mut flash), Ok(settings(1000)));
    });
    found.assert_accepted(0.8);
}

#[test]
fn a_half_that_cannot_be_read_is_not_taken_for_an_empty_one() {
    for half in [0..2 * SECTOR, 2 * SECTOR..4 * SECTOR] {
        let mut flash = history(4).pop().expect("four saves");
        let before = flash.bytes.clone();
        flash.unreadable = half;
        assert_eq!(load(&mut flash), Err(StorageError::Flash));
        assert_eq!(save(&mut flash, 5), Err(StorageError::Flash));
        assert_eq!(flash.bytes, before);
    }
}

#[test]
fn a_test_of_the_flash_keeps_the_newest_settings_and_leaves_the_other_half_blank() {
    let mut flash = Nor::blank();
    // Without settings it stays blank.
    storage(&mut flash).erase_older().expect("power is on");
    storage(&mut flash).program_older().expect("power is on");
    assert_eq!(load(&mut flash), Err(StorageError::Blank));
    for number in 1..=3 {
        save(&mut flash, number).expect("power is on");
        let mut storage = storage(&mut flash);
        storage.erase_older().expect("power is on");
        storage.program_older().expect("power is on");
        assert_eq!(storage.load(), Ok(settings(number)));
    }
}

#[test]
fn settings_survive_a_power_cut_at_every_operation_of_a_test_of_the_flash() {
    let mut before = Nor::blank();
    for number in 1..=4 {
        save(&mut before, number).expect("power is on");
    }
    for cut in CUTS {
        for at in 0..12 {
            let mut flash = before.clone();
            flash.operations = 0;
            flash.cut = Some((at, cut));
            let mut storage = storage(&mut flash);
            let _ = storage.erase_older().and_then(|()| storage.program_older());
            flash.cut = None;
            assert_eq!(load(&mut flash), Ok(settings(4)), "operation {at}");
        }
    }
}
