//! Settings in flash that survive a power cut at any moment: the old or the new ones are there.
//!
//! The flash has two halves, each a log of items by `sequential-storage` with a CRC-32 on every
//! item. A save goes to the half that does *not* hold the newest settings, with a number one
//! higher; a load takes the item with the higher number. A save that fails therefore leaves the
//! older settings in the other half untouched. (One log is not enough: it erases a sector soon
//! after it has copied the settings out of it, and a sector whose erase was interrupted can look
//! as if it were in use, which hides the copy.)

mod blocking;

use crate::Settings;
use crate::settings::{AdvancedSettings, BeltSettings, FieldLag};
use blocking::{Blocking, finish};
use core::ops::Range;
use embedded_storage::nor_flash::NorFlash;
use sequential_storage::Error;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage, PostcardValue};
use serde::{Deserialize, Serialize};

/// The layout of settings without [`AdvancedSettings`] and without belts.
const FIRST_LAYOUT: u8 = 7;
/// The first layout that ends with the belts.
const BELTS_LAYOUT: u8 = 9;
/// The first layout that ends with the lags of steppers' fields, behind the belts.
const LAGS_LAYOUT: u8 = 11;

/// Layout of the stored settings, and the key under which they are stored. Each number of
/// [`AdvancedSettings`] makes a new layout, and the belts and the lags made one each. So settings of an older
/// firmware are read, with the defaults of what they lack. Every other change of
/// [`Settings`] needs another `FIRST_LAYOUT`, so that firmware never reads the bytes of a layout
/// that it does not know.
pub const LAYOUT: u8 = FIRST_LAYOUT + AdvancedSettings::COUNT as u8 + 2;

/// Bytes of each of these numbers.
const NUMBER: usize = size_of::<f32>();
/// Bytes of the belts: of each, ten numbers and the encoder's side.
const BELTS: usize = 2 * (10 * NUMBER + 1);
/// Bytes of the lags: of each, three numbers.
const LAGS: usize = 2 * 3 * NUMBER;

/// Room for an item, its key and its padding [bytes].
const BUFFER: usize = 1024;

/// A half is erased after so many items, before they fill a sector of 128 KiB: none is longer than its buffer. From a full sector
/// the library moves what is newest to the next one, and searches the whole sector for every item
/// that it meets: 12 s on the microcontroller, longer than its watchdog waits.
const ITEMS_PER_HALF: u32 = 120;

/// Why there are no settings, or why they could not be stored. In all cases the arm must not be
/// armed on default settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum StorageError {
    /// Nothing was ever stored: the flash is blank.
    Blank,
    /// The flash is not blank and holds no undamaged settings of this [`LAYOUT`].
    Corrupt,
    /// The flash could not be read, written or erased.
    Flash,
    /// The range is not two halves of two or more whole sectors each.
    Range,
}

/// Settings with the number of their save.
#[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Item {
    number: u32,
    settings: Settings,
}

impl PostcardValue<'_> for Item {}

/// The buffer, aligned as some flash controllers need it.
#[repr(align(8))]
struct Buffer([u8; BUFFER]);

impl Buffer {
    /// The number of the item that begins at this place.
    fn number(&self, start: usize) -> Option<u32> {
        let Self(bytes) = self;
        let (number, _) = postcard::take_from_bytes(bytes.get(start..)?).ok()?;
        Some(number)
    }

    /// The bytes of the item of this layout at this place, with the defaults of what it lacks: of the numbers between it
    /// and its belts, of the belts, and of the lags behind them.
    // A call of its own: its defaults are not on the stack beside an item.
    #[inline(never)]
    fn completed(&mut self, place: Range<usize>, layout: u8) -> Option<&[u8]> {
        let Self(bytes) = self;
        let mut defaults = [0; NUMBER * AdvancedSettings::COUNT + BELTS + LAGS];
        let (numbers, last) = defaults.split_at_mut(NUMBER * AdvancedSettings::COUNT);
        postcard::to_slice(&AdvancedSettings::DEFAULT, numbers).ok()?;
        postcard::to_slice(&([BeltSettings::RIGID; 2], [FieldLag::NONE; 2]), last).ok()?;
        let (has_belts, has_lags) = (layout >= BELTS_LAYOUT, layout >= LAGS_LAYOUT);
        let others = u8::from(has_belts) + u8::from(has_lags);
        let held = usize::from(layout.checked_sub(FIRST_LAYOUT + others)?);
        let lacking = numbers.get(NUMBER * held..)?;
        let kept = BELTS * usize::from(has_belts) + LAGS * usize::from(has_lags);
        let end = place.end.checked_sub(kept)?;
        let from_item = bytes.get(end..place.end)?;
        last.get_mut(..kept)?.copy_from_slice(from_item);
        let behind = bytes.get_mut(end..end + lacking.len() + last.len())?;
        let (behind, end) = behind.split_at_mut(lacking.len());
        behind.copy_from_slice(lacking);
        end.copy_from_slice(last);
        bytes.get(place.start..)
    }
}

type Log<'f, F> = MapStorage<u8, Blocking<&'f mut F>, Cache<Uncached, Uncached, Uncached, u8>>;

/// Settings in sectors of a flash `F` that nothing else uses.
pub struct SettingsStorage<F> {
    flash: F,
    halves: [Range<u32>; 2],
}

impl<F: NorFlash> SettingsStorage<F> {
    /// Storage at these addresses of `flash`: four sectors, or a larger even number of them.
    ///
    /// # Errors
    /// [`StorageError::Range`].
    pub fn new(mut flash: F, range: Range<u32>) -> Result<Self, StorageError> {
        let middle = range.start + range.end.saturating_sub(range.start) / 2;
        let halves = [range.start..middle, middle..range.end];
        for half in &halves {
            log(&mut flash, half)?;
        }
        Ok(Self { flash, halves })
    }

    /// The settings saved last, not checked. May erase a sector that a power cut left half erased.
    ///
    /// # Errors
    /// [`StorageError::Blank`], [`StorageError::Corrupt`] or [`StorageError::Flash`].
    // A call of its own, so that its item is not on the stack of what checks the settings.
    #[inline(never)]
    pub fn load(&mut self) -> Result<Settings, StorageError> {
        let mut newest = None;
        self.search(&mut newest)?;
        match newest {
            Some((item, _)) => Ok(item.settings),
            None if self.is_blank()? => Err(StorageError::Blank),
            None => Err(StorageError::Corrupt),
        }
    }

    /// Stores settings. Afterwards [`load`](Self::load) returns them; if the power fails
    /// meanwhile, it returns these or the ones before. Erasing a large sector stalls an STM32F4
    /// for up to 2.6 s: call it only while nothing moves.
    ///
    /// # Errors
    /// [`StorageError::Flash`], or [`StorageError::Corrupt`] if the flash does not keep what is
    /// written.
    pub fn save(&mut self, settings: &Settings) -> Result<(), StorageError> {
        // Damage can hide a newer item until writing repairs it; the second pass then uses a
        // higher number.
        for _ in 0..2 {
            let (item, half) = self.next(settings)?;
            // Every second number goes to this half.
            let is_full = item.number / 2 % ITEMS_PER_HALF == ITEMS_PER_HALF - 1;
            if is_full || self.append(&half, &item).is_err() {
                // This half does not hold the newest item, so it may be erased.
                finish(log(&mut self.flash, &half)?.erase_all())?;
                self.append(&half, &item)?;
            }
            if self.is_newest(&item, &half)? {
                return Ok(());
            }
        }
        Err(StorageError::Corrupt)
    }

    /// Erases the half that does not hold the newest settings, for a test of the flash.
    ///
    /// # Errors
    /// [`StorageError::Flash`].
    pub fn erase_older(&mut self) -> Result<(), StorageError> {
        let half = self.older()?;
        finish(log(&mut self.flash, &half)?.erase_all())?;
        Ok(())
    }

    /// Programs words of that half with ones, which changes nothing, for a test of the flash.
    ///
    /// # Errors
    /// [`StorageError::Flash`].
    pub fn program_older(&mut self) -> Result<(), StorageError> {
        let half = self.older()?;
        self.flash
            .write(half.start, &[0xff; BUFFER])
            .map_err(|_| StorageError::Flash)
    }

    /// The flash itself.
    pub fn flash(&mut self) -> &mut F {
        &mut self.flash
    }

    /// The half that does not hold the newest settings.
    fn older(&mut self) -> Result<Range<u32>, StorageError> {
        let newest = self.newest_number()?;
        Ok(self.half_beside(newest.map(|(_, half)| half)))
    }

    /// The other half; the first one if no half is newest.
    fn half_beside(&self, newest: Option<Range<u32>>) -> Range<u32> {
        let [first, second] = &self.halves;
        match newest {
            Some(half) if half == *first => second.clone(),
            _ => first.clone(),
        }
    }

    /// The item to store next, and the half that does not hold the newest.
    fn next(&mut self, settings: &Settings) -> Result<(Item, Range<u32>), StorageError> {
        let (number, newest) = match self.newest_number()? {
            Some((number, half)) => (number.wrapping_add(1), Some(half)),
            None => (0, None),
        };
        let half = self.half_beside(newest);
        let settings = *settings;
        Ok((Item { number, settings }, half))
    }

    /// Appends an item to a half and reads it back: after damage, another item may be read, even
    /// a hidden one with the same number.
    fn append(&mut self, half: &Range<u32>, item: &Item) -> Result<(), StorageError> {
        let mut buffer = Buffer([0; BUFFER]);
        let mut log = log(&mut self.flash, half)?;
        finish(log.store_item(&mut buffer.0, &LAYOUT, item))?;
        match finish(log.fetch_item::<Item>(&mut buffer.0, &LAYOUT))? {
            Some(found) if found == *item => Ok(()),
            _ => Err(StorageError::Corrupt),
        }
    }

    /// The number of the item saved last, and its half.
    // Calls of their own, here and below: only one of them holds an item on the stack.
    #[inline(never)]
    fn newest_number(&mut self) -> Result<Option<(u32, Range<u32>)>, StorageError> {
        let mut newest = None;
        self.search(&mut newest)?;
        Ok(newest.map(|(item, half)| (item.number, half)))
    }

    /// Whether this item was saved last, in this half.
    #[inline(never)]
    fn is_newest(&mut self, item: &Item, half: &Range<u32>) -> Result<bool, StorageError> {
        let mut newest = None;
        self.search(&mut newest)?;
        Ok(newest.is_some_and(|(newest, there)| newest == *item && there == *half))
    }

    /// Puts the item saved last, and its half, into `newest`. What an older firmware has saved counts
    /// until this one has saved its first.
    fn search(&mut self, newest: &mut Option<(Item, Range<u32>)>) -> Result<(), StorageError> {
        for layout in (FIRST_LAYOUT..=LAYOUT).rev() {
            self.find_newest(layout, newest)?;
            if newest.is_some() {
                break;
            }
        }
        Ok(())
    }

    /// Puts the item of this layout saved last, and its half, into `newest`, if there is one.
    // In its place: the stack holds no second one.
    #[inline(never)]
    fn find_newest(
        &mut self,
        layout: u8,
        newest: &mut Option<(Item, Range<u32>)>,
    ) -> Result<(), StorageError> {
        for half in &self.halves {
            let mut buffer = Buffer([0; BUFFER]);
            let mut log = log(&mut self.flash, half)?;
            let bytes: &[u8] = match finish(log.fetch_item(&mut buffer.0, &layout)) {
                Ok(Some(bytes)) => bytes,
                Err(Error::Storage { .. }) => return Err(StorageError::Flash),
                Ok(None) | Err(_) => continue,
            };
            // The item lies anywhere in the buffer.
            let (start, length) = (bytes.as_ptr().addr(), bytes.len());
            let start = start - buffer.0.as_ptr().addr();
            let place = start..start + length;
            let Some(number) = buffer.number(place.start) else {
                continue;
            };
            // Numbers wrap: the newer one is ahead by less than half the range.
            let is_newer = newest
                .as_ref()
                .is_none_or(|(other, _)| number.wrapping_sub(other.number).cast_signed() > 0);
            if is_newer
                && let Some(bytes) = buffer.completed(place, layout)
                && let Ok(item) = postcard::from_bytes(bytes)
            {
                *newest = Some((item, half.clone()));
            }
        }
        Ok(())
    }

    // A call of its own: its bytes are not on the stack beside an item.
    #[inline(never)]
    fn is_blank(&mut self) -> Result<bool, StorageError> {
        let [first, second] = &self.halves;
        for address in (first.start..second.end).step_by(BUFFER) {
            let mut bytes = [0; BUFFER];
            self.flash
                .read(address, &mut bytes)
                .map_err(|_| StorageError::Flash)?;
            // By words: a board whose crystal does not serve starts at a tenth of its clock, and its host waits.
            let (words, rest) = bytes.as_chunks::<4>();
            let is_erased = words
                .iter()
                .all(|&word| u32::from_ne_bytes(word) == u32::MAX)
                && rest.iter().all(|&byte| byte == 0xff);
            if !is_erased {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

fn log<'f, F: NorFlash>(flash: &'f mut F, half: &Range<u32>) -> Result<Log<'f, F>, StorageError> {
    let config = MapConfig::try_new(half.clone()).map_err(|_| StorageError::Range)?;
    Ok(MapStorage::new(
        Blocking(flash),
        config,
        Cache::new_uncached(),
    ))
}

impl<E> From<Error<E>> for StorageError {
    fn from(error: Error<E>) -> Self {
        match error {
            Error::Storage { .. } => Self::Flash,
            _ => Self::Corrupt,
        }
    }
}

impl core::fmt::Display for StorageError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Blank => "no settings are stored",
            Self::Corrupt => "the stored settings are damaged or of another firmware",
            Self::Flash => "the flash memory could not be read or written",
            Self::Range => "the flash range is not two halves of two or more whole sectors",
        })
    }
}

impl core::error::Error for StorageError {}
