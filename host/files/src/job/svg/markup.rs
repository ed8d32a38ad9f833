//! The size of the markup of a drawing, before it is parsed.
//!
//! The XML reader compares each attribute of an element with those before it, and writes an entity out at each
//! reference to it. The numbers of a path are the most points that it can have.

use crate::budget::Budget;

/// Most attributes of an element: those of SVG and of its programs are fewer.
const MOST_ATTRIBUTES: usize = 200;
/// Most attributes of a document.
const MOST_IN_ALL: usize = 2_000_000;
/// Most characters that entities may become.
const MOST_WRITTEN_OUT: usize = 64 << 20;
/// Most references within an entity that the XML reader follows.
const REFERENCES: usize = 255;
/// Numbers of a document for each point of its drawing: two coordinates, and as many for styles and transforms.
const NUMBERS: usize = 4;

/// Why a document is too large to be parsed.
pub(super) fn refusal(text: &str) -> Option<String> {
    let count = |byte: u8| text.bytes().filter(|&it| it == byte).count();
    let attributes = count(b'=');
    if attributes > MOST_IN_ALL {
        return Some(format!(
            "the SVG has {attributes} attributes, more than {MOST_IN_ALL}: simplify it"
        ));
    }
    let most = text.split('<').map(attributes_of).max().unwrap_or(0);
    if most > MOST_ATTRIBUTES {
        return Some(format!(
            "an element of the SVG has {most} attributes, more than {MOST_ATTRIBUTES}: leave them out"
        ));
    }
    if let Some(declared) = text.find("<!ENTITY") {
        let end = text.rfind("]>").unwrap_or(text.len());
        let length = text.get(declared..end).map_or(0, str::len);
        let written = count(b'&')
            .saturating_mul(length)
            .saturating_mul(REFERENCES);
        if written > MOST_WRITTEN_OUT {
            let reason = "the SVG refers to its entities too often: save it as a plain SVG";
            return Some(reason.into());
        }
    }
    let is_picture = |value: &&str| value.trim_start().starts_with("data:");
    let values = text.split(['"', '\'']).filter(|value| !is_picture(value));
    let numbers: usize = values.map(numbers_of).sum();
    let over = Budget::points().take(numbers / NUMBERS).err()?;
    Some(format!("the SVG is too large: {over}"))
}

/// The attributes of the element that begins here, if one does.
fn attributes_of(text: &str) -> usize {
    if !text.starts_with(|c: char| c.is_alphabetic()) {
        return 0;
    }
    let tag = text.split('>').next().unwrap_or_default();
    tag.bytes().filter(|&byte| byte == b'=').count()
}

/// The numbers in a text.
fn numbers_of(text: &str) -> usize {
    let is_digit = |byte: &u8| byte.is_ascii_digit();
    let starts = |pair: &[u8]| is_digit(&pair[1]) && !is_digit(&pair[0]);
    text.as_bytes()
        .windows(2)
        .filter(|pair| starts(pair))
        .count()
}
