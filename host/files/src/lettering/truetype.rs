//! The font as a TrueType file in memory, for readers of SVG that lay out texts with such fonts.
//!
//! TrueType fills closed contours. A stroke becomes a contour that goes along the stroke and back on the same points, so that it
//! encloses nothing. Readers leave out what has no width or no height, such as an l; so each glyph also has a tiny contour that
//! goes to and fro twice, as no stroke does, by which [`drawn_once`] knows it. The tables are those that a layout needs: sizes (head, hhea, maxp), widths (hmtx), characters (cmap) and
//! contours (loca, glyf), each as in the OpenType specification.

use super::glyph::{CAPITAL, Glyph, characters, glyph};
use std::collections::BTreeMap;

/// Units of the file per unit of the font, because its coordinates are whole numbers.
const FINE: f64 = 10.0;
/// Units of the file per em: capital letters have 0.7 of it, as in most fonts.
const EM: u16 = 300;

/// The contour that gives each glyph a width and a height.
const TO_AND_FRO: [[i16; 2]; 4] = [[0, 0], [1, 1], [0, 0], [1, 1]];

/// The stroke of a contour of this font, and any other contour as it is; none of [`TO_AND_FRO`].
pub(crate) fn drawn_once(mut contour: Vec<[f64; 2]>) -> Option<Vec<[f64; 2]>> {
    let returns = contour.len() > 2 && contour.iter().eq(contour.iter().rev());
    if returns && contour.len() > TO_AND_FRO.len() && contour[0] == contour[2] {
        return None;
    }
    if returns {
        contour.truncate(contour.len() / 2 + 1);
    }
    Some(contour)
}

/// The bytes of the font.
pub(crate) fn font() -> Vec<u8> {
    let mut of: BTreeMap<char, Glyph> = BTreeMap::new();
    of.extend(characters().filter_map(|it| Some((it, glyph(it)?))));
    // Glyph 0 stands for all characters that have none.
    let glyphs: Vec<Glyph> = [Glyph::default()]
        .into_iter()
        .chain(of.values().cloned())
        .collect();
    let contours: Vec<Vec<u8>> = glyphs.iter().map(contours).collect();
    let mut widths = Bytes::default();
    for glyph in &glyphs {
        let points = glyph.strokes.iter().flatten();
        let left = points
            .map(|point| fine(point[0]))
            .fold(TO_AND_FRO[0][0], i16::min);
        widths.u16s(&[fine(glyph.advance), left].map(i16::cast_unsigned));
    }
    let mut places = Bytes::default();
    let mut end = 0;
    for length in [0].into_iter().chain(contours.iter().map(Vec::len)) {
        end += length as u32;
        places.u32(end);
    }
    let count = glyphs.len() as u16;
    file(&[
        (*b"cmap", cmap(of.keys())),
        (*b"glyf", contours.concat()),
        (*b"head", head()),
        (*b"hhea", hhea(count)),
        (*b"hmtx", widths.0),
        (*b"loca", places.0),
        (*b"maxp", maxp(count)),
    ])
}

/// Bytes with the most significant one first.
#[derive(Default)]
struct Bytes(Vec<u8>);

impl Bytes {
    fn u16s(&mut self, values: &[u16]) {
        self.0.extend(values.iter().flat_map(|it| it.to_be_bytes()));
    }

    fn u32(&mut self, value: u32) {
        self.0.extend(value.to_be_bytes());
    }
}

fn fine(length: f64) -> i16 {
    (FINE * length).round() as i16
}

/// The table directory and the tables, each filled up to four bytes.
fn file(tables: &[([u8; 4], Vec<u8>)]) -> Vec<u8> {
    let mut bytes = Bytes::default();
    bytes.u32(0x0001_0000);
    // The number of tables, and three numbers for a search by halves: 4 tables are the last power of two.
    bytes.u16s(&[tables.len() as u16, 64, 2, 16 * tables.len() as u16 - 64]);
    let mut at = 12 + 16 * tables.len();
    for (name, table) in tables {
        bytes.0.extend(name);
        // No reader here compares check sums.
        bytes.u32(0);
        bytes.u32(at as u32);
        bytes.u32(table.len() as u32);
        at += table.len().next_multiple_of(4);
    }
    for (_, table) in tables {
        bytes.0.extend(table);
        let filled = bytes.0.len().next_multiple_of(4);
        bytes.0.resize(filled, 0);
    }
    bytes.0
}

/// The contours of a glyph: the last point of each, the flags (all points lie on the contour), x and y as steps.
fn contours(glyph: &Glyph) -> Vec<u8> {
    if glyph.strokes.is_empty() && glyph.advance > 0.0 {
        return Vec::new();
    }
    let there_and_back = |stroke: &Vec<[f64; 2]>| -> Vec<[i16; 2]> {
        let there = stroke.iter().map(|point| point.map(fine));
        let back = there.clone().rev().skip(1).take(stroke.len() - 2);
        there.chain(back).collect()
    };
    let mut contours: Vec<Vec<[i16; 2]>> = glyph.strokes.iter().map(there_and_back).collect();
    contours.push(TO_AND_FRO.to_vec());
    let points: Vec<[i16; 2]> = contours.concat();
    let range = |axis: usize| {
        let along = points.iter().map(|point| point[axis]);
        [along.clone().min().unwrap_or(0), along.max().unwrap_or(0)]
    };
    let [x, y] = [range(0), range(1)];
    let mut bytes = Bytes::default();
    bytes.u16s(&[contours.len() as u16]);
    bytes.u16s(&[x[0], y[0], x[1], y[1]].map(i16::cast_unsigned));
    let mut last = 0;
    for contour in &contours {
        last += contour.len() as u16;
        bytes.u16s(&[last - 1]);
    }
    bytes.u16s(&[0]);
    bytes.0.resize(bytes.0.len() + points.len(), 1);
    for axis in [0, 1] {
        let mut at = 0;
        for point in &points {
            bytes.u16s(&[(point[axis] - at).cast_unsigned()]);
            at = point[axis];
        }
    }
    let filled = bytes.0.len().next_multiple_of(4);
    bytes.0.resize(filled, 0);
    bytes.0
}

/// Characters to glyphs, format 12: a group for each character.
fn cmap<'a>(characters: impl Iterator<Item = &'a char>) -> Vec<u8> {
    let mut groups = Bytes::default();
    let mut count = 0;
    for &of in characters {
        count += 1;
        for value in [of as u32, of as u32, count] {
            groups.u32(value);
        }
    }
    let mut bytes = Bytes::default();
    // Version, one table: for Windows, all of Unicode, 12 bytes from here.
    bytes.u16s(&[0, 1, 3, 10]);
    bytes.u32(12);
    bytes.u16s(&[12, 0]);
    for value in [16 + groups.0.len() as u32, 0, count] {
        bytes.u32(value);
    }
    bytes.0.extend(groups.0);
    bytes.0
}

fn head() -> Vec<u8> {
    let mut bytes = Bytes::default();
    for value in [0x0001_0000, 0x0001_0000, 0, 0x5F0F_3CF5] {
        bytes.u32(value);
    }
    // Flags, units per em, two dates of 8 bytes, the box, style, least size, direction, places of 32 bits, format.
    bytes.u16s(&[0, EM, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, EM, EM, 0, 8, 2, 1, 0]);
    bytes.0
}

fn hhea(count: u16) -> Vec<u8> {
    let mut bytes = Bytes::default();
    bytes.u32(0x0001_0000);
    let down = fine(-0.4 * CAPITAL).cast_unsigned();
    bytes.u16s(&[EM, down, 0, EM, 0, 0, EM, 1, 0, 0, 0, 0, 0, 0, 0, count]);
    bytes.0
}

fn maxp(count: u16) -> Vec<u8> {
    let mut bytes = Bytes::default();
    bytes.u32(0x0001_0000);
    // The most points, contours, zones, and what instructions need, of which there are none.
    bytes.u16s(&[count, 1000, 100, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0]);
    bytes.0
}
