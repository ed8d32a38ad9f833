//! Files that are no jobs: named, with the way to make a job of them.

use crate::placed::AS_WRITTEN;
use fivebar_files::job::{self, Job};

fn refusal(bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    std::fs::write(&path, bytes).unwrap();
    let text = job::read(&path).unwrap();
    Job::parse(&text, &AS_WRITTEN).unwrap_err().to_string()
}

#[test]
fn other_formats_are_refused_by_name_with_the_remedy() {
    let solid = [&[b' '; 80][..], &[2, 0, 0, 0], &[0; 100]].concat();
    for (bytes, name, remedy) in [
        (&b"GIF89a\x01\0"[..], "a GIF picture", "save it as a PNG"),
        ("\u{FFFD}PNG".as_bytes(), "a PNG picture", "the file itself"),
        (b"%PDF-1.5\n%\xB5\xED", "a PDF", "Inkscape"),
        (b"%!PS-Adobe-3.0 EPSF-3.0\n", "a PostScript", "Inkscape"),
        (b"\xC5\xD0\xD3\xC6\x1E\0\0\0", "a PostScript", "Inkscape"),
        (b"AutoCAD Binary DXF\r\n\x1a\0", "a binary DXF", "SVG"),
        (b"AC1032\0\0", "a DWG drawing", "SVG"),
        (b"PK\x03\x04\x14\0", "a 3MF", "export"),
        (b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1", "an Office", "SVG"),
        (
            b"solid cube\nfacet normal 0 0 1\n",
            "an STL solid",
            "slicer",
        ),
        (&solid, "a binary file, such as an STL solid", "G-code"),
        (
            b"<?xml version=\"1.0\"?>\n<!-- by a watch --><gpx version=\"1.1\"/>",
            "a GPX track",
            "SVG",
        ),
        (
            b"<!DOCTYPE html>\n<html></html>",
            "a web page",
            "drawing itself",
        ),
        (
            b"<LightBurnProject AppVersion=\"1.4\">",
            "a LightBurn project",
            "export",
        ),
        (b"{\"type\": 1}", "JSON", "export"),
        (b"", "an empty file", "save the job again"),
        (b"\xEF\xBB\xBF \r\n", "an empty file", "save the job again"),
    ] {
        let why = refusal(bytes);
        assert!(why.starts_with(&format!("this is {name}")), "{name}: {why}");
        assert!(why.contains(remedy), "{name}: {why}");
    }
}

#[test]
fn a_compressed_drawing_is_read_and_a_damaged_one_refused() {
    // `gzip -9n` of an SVG with a line from (1, 9) to (9, 9) mm on a page of 10 mm.
    let bytes = include_bytes!("../corpus/compressed.svgz");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drawing.svgz");
    std::fs::write(&path, bytes).unwrap();
    let job = Job::parse(&job::read(&path).unwrap(), &AS_WRITTEN).unwrap();
    assert!(job.is_drawing && job.steps.len() == 2);
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    assert!(job::read(&path).is_err());
}

#[test]
fn the_page_offers_the_endings_that_are_read() {
    let page = include_str!("../../../fivebar/src/serve/page/index.html");
    let offered = page
        .split_once("accept=\"")
        .unwrap()
        .1
        .split('"')
        .next()
        .unwrap();
    let offered: Vec<&str> = offered
        .split(',')
        .map(|it| it.trim_start_matches('.'))
        .collect();
    assert_eq!(offered, fivebar_files::job::ENDINGS);
}
