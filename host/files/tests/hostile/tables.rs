//! Hostile tables and pictures.

use crate::{Input, Kind, counted};

/// A PNG whose header states a size, with these compressed rows.
pub(crate) fn png(size: [u32; 2], rows: &[u8]) -> Vec<u8> {
    png_with(size, rows, png::chunk::tEXt, &[], 0)
}

/// The same with another chunk before the rows, so often.
fn png_with(
    [width, height]: [u32; 2],
    rows: &[u8],
    chunk: png::chunk::ChunkType,
    content: &[u8],
    count: usize,
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Sixteen);
    let mut writer = encoder.write_header().expect("a header");
    for _ in 0..count {
        writer.write_chunk(chunk, content).expect("a chunk");
    }
    writer.write_chunk(png::chunk::IDAT, rows).expect("a chunk");
    drop(writer);
    // The header's chunk begins behind the signature of 8 bytes: its length, its name, its content and its sum.
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let mut sum = flate2::Crc::new();
    sum.update(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&sum.sum().to_be_bytes());
    bytes
}

/// Zeros, compressed.
pub(crate) fn zeros(count: usize) -> Vec<u8> {
    use std::io::Write as _;
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(&vec![0; count]).expect("memory");
    encoder.finish().expect("memory")
}

/// A progressive JPEG of this size, in colour and all grey, with so many scans of one component after that of all.
pub(crate) fn jpeg(size: u16, scans: usize) -> Vec<u8> {
    let [high, low] = size.to_be_bytes();
    let mut bytes = vec![0xff, 0xd8, 0xff, 0xdb, 0, 67, 0];
    bytes.extend([1; 64]);
    bytes.extend([
        0xff, 0xc2, 0, 17, 8, high, low, high, low, 3, 1, 0x11, 0, 2, 0x11, 0, 3, 0x11, 0,
    ]);
    for class in [0x00, 0x10] {
        // A code of one bit that stands for 0: no difference, or the end of a block.
        bytes.extend([0xff, 0xc4, 0, 20, class, 1]);
        bytes.extend([0; 16]);
    }
    let blocks = usize::from(size).div_ceil(8).pow(2);
    bytes.extend([0xff, 0xda, 0, 12, 3, 1, 0, 2, 0, 3, 0, 0, 0, 0]);
    bytes.extend(vec![0; (3 * blocks).div_ceil(8)]);
    for scan in 0..scans {
        let component = 1 + (scan % 3) as u8;
        bytes.extend([0xff, 0xda, 0, 8, 1, component, 0, 1, 63, 0]);
        bytes.extend(vec![0; blocks.div_ceil(8)]);
    }
    bytes.extend([0xff, 0xd9]);
    bytes
}

pub(crate) fn kinds() -> Vec<Kind> {
    let mut kinds: Vec<Kind> = Vec::new();
    for (name, head, part, count) in [
        ("a line without end", "x,y\n", "1", 3_000_000),
        ("columns", "x,y", ",a", 400_000),
        ("quotation marks", "x,y\n", "\"", 500_000),
        ("numbers of nothing", "x,y\n", "nan,inf\n", 10),
        ("rows", "x,y\n", "1,2\n", 300_000),
        ("rows of another length", "x,y\n", "1\n", 1000),
        ("zeros", "x,y\n", "\0", 500_000),
    ] {
        let table = move || Input::Table(format!("{head}{}", part.repeat(counted(count))));
        kinds.push((format!("table: {name}"), Box::new(table)));
    }
    for size in [[30_000, 30_000], [9_500, 9_500], [4_000_000_000, 400]] {
        let picture = move || Input::Picture(png(size, &zeros(1 << 20)));
        kinds.push((format!("picture: a PNG of {size:?}"), Box::new(picture)));
    }
    for (name, begin, part, count) in [
        ("rows without end", "x,y\n", "1.25,2\n", 30_000_000),
        (
            "columns that are left out",
            "x,y,a,b,c,d\n",
            "1,2,3,4,5,6\n",
            40_000_000,
        ),
        ("a text of lines without end", "x,y\n\"", "a\n", 250_000_000),
        ("empty lines", "x,y\n", "\n", 500_000_000),
    ] {
        let table = move || Input::Stream(begin.into(), part.into(), counted(count));
        kinds.push((format!("table: {name}"), Box::new(table)));
    }
    for (name, chunk) in [
        ("texts", png::chunk::ChunkType(*b"zTXt")),
        ("profiles", png::chunk::iCCP),
    ] {
        // Zeros of 16 MiB behind a name, 200 times.
        let picture = move || {
            let content = [&b"a\0\0"[..], &zeros(16 << 20)].concat();
            let rows = zeros(400 * (8 * 400 + 1));
            Input::Picture(png_with([400, 400], &rows, chunk, &content, counted(200)))
        };
        kinds.push((
            format!("picture: a PNG of compressed {name}"),
            Box::new(picture),
        ));
    }
    for (size, scans) in [
        (65_500, 0),
        (8_900, 3),
        (8_900, 19),
        (8_900, 100),
        (400, 20_000),
    ] {
        let name = format!("picture: a JPEG of {size} with {scans} scans");
        let picture = move || {
            // As many pixels as the parts of others.
            let size = counted(size * size).isqrt().max(400) as u16;
            Input::Picture(jpeg(size, counted(scans)))
        };
        kinds.push((name, Box::new(picture)));
    }
    let marks = || {
        let marks = [0xff, 0xe1, 0, 2].repeat(counted(1_000_000));
        Input::Picture([&[0xff, 0xd8][..], &marks, &jpeg(400, 0)[2..]].concat())
    };
    kinds.push(("picture: a JPEG of marks".into(), Box::new(marks)));
    kinds
}
