//! XML documents in memory.

use quick_xml::Writer;
use std::io;

/// What elements are written to.
pub(super) type Xml = Writer<Vec<u8>>;

/// The document that `write` writes, an element a line.
pub(super) fn document(write: impl FnOnce(&mut Xml) -> io::Result<()>) -> String {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    write(&mut xml).expect("writing into memory does not fail");
    let text = String::from_utf8(xml.into_inner()).expect("all that was written is text");
    text + "\n"
}

/// An element with attributes and nothing in it. Attributes are escaped.
pub(super) fn element(xml: &mut Xml, name: &str, attributes: &[(&str, &str)]) -> io::Result<()> {
    let element = xml.create_element(name);
    element
        .with_attributes(attributes.iter().copied())
        .write_empty()
        .map(drop)
}

/// An element with attributes around what `inner` writes.
pub(super) fn around(
    xml: &mut Xml,
    name: &str,
    attributes: &[(&str, &str)],
    inner: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    let element = xml.create_element(name);
    element
        .with_attributes(attributes.iter().copied())
        .write_inner_content(inner)
        .map(drop)
}
