//! What a long job keeps in memory, in few bytes: moves that are read one by one, and what is seldom read.
//!
//! A move takes 80 bytes in memory because of its longest kind, and some 20 as postcard writes it.

use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::{Read as _, Write as _};
use std::marker::PhantomData;

/// Entries between two whose places are known.
const CHUNK: usize = 64;
/// What was written here is read here.
const OWN: &str = "memory holds what was written into it";

/// A list whose entries are read in order from any one on.
pub(super) struct Packed<T> {
    bytes: Box<[u8]>,
    /// Where each chunk begins in the bytes.
    begins: Box<[usize]>,
    len: usize,
    entries: PhantomData<fn() -> T>,
}

impl<T: Serialize + DeserializeOwned> Packed<T> {
    pub(super) fn of(entries: &[T]) -> Self {
        let (mut bytes, mut begins) = (Vec::new(), Vec::new());
        for (index, entry) in entries.iter().enumerate() {
            if index.is_multiple_of(CHUNK) {
                begins.push(bytes.len());
            }
            bytes = postcard::to_extend(entry, bytes).expect(OWN);
        }
        Self {
            bytes: bytes.into(),
            begins: begins.into(),
            len: entries.len(),
            entries: PhantomData,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn get(&self, index: usize) -> Option<T> {
        self.from(index).next()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = T> {
        self.from(0)
    }

    /// The entries from this one on.
    pub(super) fn from(&self, index: usize) -> impl Iterator<Item = T> {
        let begin = self.begins.get(index / CHUNK);
        let mut rest = begin.map_or(&[][..], |&begin| &self.bytes[begin..]);
        let entries = std::iter::from_fn(move || {
            if rest.is_empty() {
                return None;
            }
            let (entry, behind) = postcard::take_from_bytes(rest).expect(OWN);
            rest = behind;
            Some(entry)
        });
        entries.skip(index % CHUNK)
    }

    /// All entries, for work that needs them beside each other.
    pub(super) fn unpacked(&self) -> Vec<T> {
        let mut entries = Vec::with_capacity(self.len);
        entries.extend(self.iter());
        entries
    }
}

/// A value that is seldom read, compressed.
pub(super) struct Shelved<T> {
    bytes: Box<[u8]>,
    value: PhantomData<fn() -> T>,
}

impl<T: Serialize + DeserializeOwned> Shelved<T> {
    pub(super) fn of(value: &T) -> Self {
        let plain = postcard::to_extend(value, Vec::new()).expect(OWN);
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(&plain).expect(OWN);
        Self {
            bytes: encoder.finish().expect(OWN).into(),
            value: PhantomData,
        }
    }

    pub(super) fn value(&self) -> T {
        let mut plain = Vec::new();
        let mut decoder = DeflateDecoder::new(&self.bytes[..]);
        decoder.read_to_end(&mut plain).expect(OWN);
        postcard::from_bytes(&plain).expect(OWN)
    }
}

#[cfg(test)]
mod tests {
    use super::{CHUNK, Packed, Shelved};
    use fivebar_firmware::{Move, MoveKind};

    fn moves(count: usize) -> Vec<Move> {
        let one = |index: usize| Move {
            tag: index as u32,
            tool: 7 * index as u16,
            kind: match index % 3 {
                0 => MoveKind::Dwell {
                    duration: index as f32,
                },
                _ => MoveKind::Line {
                    to: [0.1 * index as f32, -0.3],
                    feed: 0.05,
                },
            },
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn a_packed_list_has_its_entries_at_their_places() {
        for count in [0, 1, CHUNK - 1, CHUNK, CHUNK + 1, 5 * CHUNK + 7] {
            let whole = moves(count);
            let packed = Packed::of(&whole);
            assert_eq!((packed.len(), packed.unpacked()), (count, whole.clone()));
            for index in 0..count + 2 {
                assert_eq!(packed.get(index), whole.get(index).copied(), "{index}");
                let rest: Vec<Move> = packed.from(index).collect();
                assert_eq!(rest, whole.get(index..).unwrap_or_default());
            }
        }
    }

    #[test]
    fn a_line_takes_a_quarter_of_its_size_and_what_is_shelved_comes_back() {
        let whole = moves(100 * CHUNK);
        let packed = Packed::of(&whole);
        assert!(
            4 * packed.bytes.len() < size_of_val(&whole[..]),
            "{}",
            packed.bytes.len()
        );
        let shelved = Shelved::of(&whole);
        assert_eq!(shelved.value(), whole);
        let text = "G1 X10 Y20\n".repeat(1000);
        let shelved = Shelved::of(&text);
        assert!(50 * shelved.bytes.len() < text.len());
        assert_eq!(shelved.value(), text);
    }
}
