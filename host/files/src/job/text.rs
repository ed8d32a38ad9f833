//! The bytes of a job's file as text.

use super::trace::data_uri;
use crate::text_file;
use flate2::read::GzDecoder;
use std::io;
use std::path::Path;

/// The first bytes of a file that gzip has compressed, such as .svgz.
const GZIP: [u8; 2] = [0x1F, 0x8B];
/// The byte order mark.
const MARK: char = '\u{FEFF}';

/// Reads the text of a job's file, or of the standard input if the path is `-`. G-code is ASCII, but comments have any encoding:
/// bytes that are not UTF-8 become U+FFFD, which is refused outside comments. A PNG or a JPEG becomes a data URI, and a file that
/// gzip has compressed is decompressed. A byte order mark is kept. UTF-16 with a mark is read as such and then has two marks, by
/// which [`super::Job::parse`] notes it.
///
/// # Errors
/// The file cannot be read, or is larger than 64 MiB.
pub fn read(path: &Path) -> io::Result<String> {
    let bytes = text_file::read_bytes(path, text_file::LARGEST_GCODE)?;
    if let Some(picture) = data_uri::as_text(&bytes) {
        return Ok(picture);
    }
    if !bytes.starts_with(&GZIP) {
        return Ok(decoded(&bytes));
    }
    let bytes = text_file::read_stream(GzDecoder::new(&bytes[..]), text_file::LARGEST_GCODE)?;
    Ok(decoded(&bytes))
}

fn decoded(bytes: &[u8]) -> String {
    let unit: fn([u8; 2]) -> u16 = match bytes {
        [0xFF, 0xFE, ..] => u16::from_le_bytes,
        [0xFE, 0xFF, ..] => u16::from_be_bytes,
        _ => return String::from_utf8_lossy(bytes).into_owned(),
    };
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    let text = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER));
    [MARK].into_iter().chain(text).collect()
}

/// The text without its byte order marks, and whether it was UTF-16.
pub(super) fn without_mark(text: &str) -> (&str, bool) {
    let Some(text) = text.strip_prefix(MARK) else {
        return (text, false);
    };
    match text.strip_prefix(MARK) {
        Some(text) => (text, true),
        None => (text, false),
    }
}
