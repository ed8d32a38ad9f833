//! The format of a job's file, by its first characters.
//!
//! The live page sends text, in which a byte that is no UTF-8 is U+FFFD, so the marks of binary
//! formats are compared in that form.

use super::trace::data_uri::is_picture;

/// What reads a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Gcode,
    Svg,
    Hpgl,
    Dxf,
    Picture,
    /// It is no job.
    Foreign {
        name: &'static str,
        /// How to make a job of it.
        remedy: &'static str,
    },
}

const TRACE: &str = "save it as a PNG or a JPEG, which are drawn";
const AS_TEXT: &str = "it was damaged on its way as text: give the file itself";
const VECTORS: &str = "open it in Inkscape and save it as a plain SVG";
const SLICE: &str = "a slicer makes G-code of a solid; a drawing of it is an SVG";
const PROJECT: &str = "open it in the program that wrote it, and export G-code or an SVG";
const TRACK: &str = "it has points on a map: convert them to an SVG, such as by QGIS or gpxsvg";
const DRAWING: &str = "save it as an SVG, such as by Inkscape, LibreCAD or QCAD";

/// Formats by their first characters.
const MARKS: [(&str, &str, &str); 24] = [
    ("\u{FFFD}PNG", "a PNG picture", AS_TEXT),
    (
        "\u{FFFD}\u{FFFD}\u{FFFD}\u{FFFD}\0",
        "a JPEG picture",
        AS_TEXT,
    ),
    ("GIF8", "a GIF picture", TRACE),
    ("BM", "a BMP picture", TRACE),
    ("RIFF", "a WebP picture", TRACE),
    ("II*\0", "a TIFF picture", TRACE),
    ("MM\0*", "a TIFF picture", TRACE),
    ("%PDF-", "a PDF or an Illustrator file", VECTORS),
    ("%!PS", "a PostScript file", VECTORS),
    (
        "\u{FFFD}\u{FFFD}\u{FFFD}\u{FFFD}\u{1E}",
        "a PostScript file",
        VECTORS,
    ),
    ("AC10", "a DWG drawing", DRAWING),
    ("AutoCAD Binary DXF", "a binary DXF drawing", DRAWING),
    ("PK\u{3}\u{4}", "a 3MF file or another ZIP archive", PROJECT),
    ("\u{1F}\u{FFFD}", "a compressed file", "decompress it first"),
    ("solid ", "an STL solid", SLICE),
    ("ISO-10303-21", "a STEP solid", SLICE),
    ("<gpx", "a GPX track", TRACK),
    ("<kml", "a KML track", TRACK),
    (
        "<!doctype html",
        "a web page",
        "save the drawing itself, not its page",
    ),
    (
        "<html",
        "a web page",
        "save the drawing itself, not its page",
    ),
    ("<lightburnproject", "a LightBurn project", PROJECT),
    ("{", "JSON", PROJECT),
    ("\u{FFFD}\u{FFFD}\u{11}", "an Office document", VECTORS),
    ("{\\rtf", "an RTF text", VECTORS),
];

/// More zeros than this in the first characters, and a file is no text.
const MOST_ZEROS: usize = 10;
const BEGINNING: usize = 1000;

/// The format of a text.
pub(super) fn of(text: &str) -> Format {
    let start = text.trim_start();
    if start.is_empty() {
        return foreign(
            "an empty file",
            "save the job again; its program may have stopped early",
        );
    }
    if is_picture(text) {
        return Format::Picture;
    }
    // The root of XML comes after its declaration, comments and a document type.
    let root = root(start);
    let longest = |(mark, ..): &&(&str, &str, &str)| mark.len();
    let marks = MARKS.iter().filter(|(mark, ..)| {
        let of = if mark.starts_with('<') { root } else { start };
        begins(of, mark)
    });
    if let Some(&(_, name, remedy)) = marks.max_by_key(longest) {
        return foreign(name, remedy);
    }
    if start.starts_with('<') {
        return Format::Svg;
    }
    if is_dxf(start) {
        return Format::Dxf;
    }
    if is_hpgl(start) {
        return Format::Hpgl;
    }
    // A text has no zeros, but for a damaged one.
    let zeros = |text: &str| text.chars().take(BEGINNING).filter(|&c| c == '\0').count();
    if zeros(text) > MOST_ZEROS {
        return foreign(
            "a binary file, such as an STL solid",
            "a job is a text of G-code or HPGL, or an SVG drawing",
        );
    }
    Format::Gcode
}

fn foreign(name: &'static str, remedy: &'static str) -> Format {
    Format::Foreign { name, remedy }
}

fn begins(text: &str, mark: &str) -> bool {
    let start = text.get(..mark.len());
    start.is_some_and(|start| start.eq_ignore_ascii_case(mark))
}

/// The text from the first element of XML on.
fn root(mut text: &str) -> &str {
    while text.starts_with("<?") || (text.starts_with("<!") && !begins(text, "<!doctype html")) {
        let end = if text.starts_with("<!--") { "-->" } else { ">" };
        let Some((_, rest)) = text.split_once(end) else {
            return text;
        };
        text = rest.trim_start();
    }
    text
}

/// DXF has a line with a number before each line with its value; 0 SECTION is first, but for
/// comments after 999.
fn is_dxf(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim);
    match (lines.next(), lines.next()) {
        (Some("0"), Some(value)) => value == "SECTION",
        (Some("999"), Some(_)) => true,
        _ => false,
    }
}

/// HPGL has commands of two letters: it begins with one that starts a plot, chooses a pen or moves
/// it, or with an escape of the plotter. Words of G-code have one letter.
fn is_hpgl(text: &str) -> bool {
    const FIRST: [&str; 12] = [
        "IN", "DF", "SP", "PU", "PD", "PA", "PR", "IP", "SC", "VS", "BP", "PS",
    ];
    text.starts_with('\u{1B}')
        || FIRST.iter().any(|command| {
            begins(text, command)
                && text.get(2..).is_some_and(|rest| {
                    let letters = rest.chars().take_while(char::is_ascii_alphabetic);
                    letters.count() % 2 == 0
                })
        })
}
