//! XML documents in memory.

use quick_xml::Writer;
use std::io;

/// A writer of XML in memory.
pub(super) type Xml = Writer<Vec<u8>>;

/// The document that `write` writes, one element per line.
pub(super) fn document(write: impl FnOnce(&mut Xml) -> io::Result<()>) -> String {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    write(&mut xml).expect("writing to memory cannot fail");
    let text = String::from_utf8(xml.into_inner()).expect("the elements are UTF-8");
    text + "\n"
}

/// Writes an empty element with attributes. The writer escapes them.
pub(super) fn element(xml: &mut Xml, name: &str, attributes: &[(&str, &str)]) -> io::Result<()> {
    let element = xml.create_element(name);
    element
        .with_attributes(attributes.iter().copied())
        .write_empty()
        .map(drop)
}

/// Writes an element with attributes; `inner` writes its content.
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
