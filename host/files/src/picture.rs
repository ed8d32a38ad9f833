//! Pictures, PNG and JPEG, as shades of grey: photographs of drawings, and pictures that become jobs.

use super::source::FileError;
use super::text_file::read_bytes;
use crate::budget::Budget;
use fivebar_design::photo::Picture;
use std::io::Cursor;
use std::path::Path;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Greatest size of a file [bytes].
const LARGEST: u64 = 128 << 20;
/// Most scans of a progressive JPEG: cameras write ten.
const MOST_SCANS: usize = 20;
/// Longest side [pixels].
const LONGEST: usize = 40_000;

const INCOMPLETE: &str = "the picture is not complete: copy it or save it again";

/// The greys of a picture, row by row from the top.
#[derive(Debug, PartialEq)]
pub(crate) struct Greys {
    /// Columns and rows.
    pub(crate) size: [usize; 2],
    pub(crate) grey: Vec<u8>,
}

/// What a picture is read for.
#[derive(Clone, Copy)]
struct Purpose {
    /// Least shorter side [pixels].
    shortest: usize,
    pixels: fn() -> Budget,
    /// The grey of red, green and blue.
    grey: fn([u8; 3]) -> u8,
}

/// A photograph of a drawing: four marks and a drawing need some pixels, and ink of any colour is dark on white paper.
const PHOTOGRAPH: Purpose = Purpose {
    shortest: 300,
    pixels: Budget::pixels,
    grey: |[red, green, blue]| red.min(green).min(blue),
};

/// A picture to be drawn: as bright as the eye sees it (the luma of ITU-R BT.601).
const JOB: Purpose = Purpose {
    shortest: 1,
    pixels: Budget::traced_pixels,
    grey: |[red, green, blue]| {
        let [red, green, blue] = [red, green, blue].map(u32::from);
        ((299 * red + 587 * green + 114 * blue + 500) / 1000) as u8
    },
};

/// Reads a picture, PNG or JPEG by its first bytes.
///
/// # Errors
/// A file that cannot be read, of another format, broken, or with a size that is no photograph's.
pub fn read_picture(path: &Path) -> Result<Picture, FileError> {
    let file = path.display().to_string();
    let refuse = |reason: String| FileError::new(&file, reason);
    let bytes = read_bytes(path, LARGEST).map_err(|error| refuse(error.to_string()))?;
    parse_picture(&file, &bytes)
}

/// The picture of a file's bytes; errors name the file.
///
/// # Errors
/// As [`read_picture`].
pub fn parse_picture(file: &str, bytes: &[u8]) -> Result<Picture, FileError> {
    let picture = decoded(bytes, PHOTOGRAPH).and_then(|Greys { size, grey }| {
        Picture::new(size[0], size[1], grey).ok_or_else(|| INCOMPLETE.into())
    });
    picture.map_err(|reason| FileError::new(file, reason))
}

/// The greys of a picture that is to be drawn; or else why it has none.
pub(crate) fn greys_to_draw(bytes: &[u8]) -> Result<Greys, String> {
    decoded(bytes, JOB)
}

/// The media type of the pictures that are read, by their first bytes.
pub(crate) fn media_type(bytes: &[u8]) -> Option<&'static str> {
    match *bytes {
        [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
        [0xff, 0xd8, 0xff, ..] => Some("image/jpeg"),
        _ => None,
    }
}

fn decoded(bytes: &[u8], purpose: Purpose) -> Result<Greys, String> {
    match media_type(bytes) {
        Some("image/png") => png(bytes, purpose),
        Some(_) => jpeg(bytes, purpose),
        None => Err(other_format(bytes)),
    }
}

fn png(bytes: &[u8], purpose: Purpose) -> Result<Greys, String> {
    let broken = |error| match error {
        png::DecodingError::LimitsExceeded => {
            "the PNG's lines are too long: save it with fewer pixels".into()
        }
        error => format!("the PNG is broken: {error}; copy it or save it again"),
    };
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(broken)?;
    let info = reader.info();
    let size = sized(info.width as usize, info.height as usize, purpose)?;
    let length = reader.output_buffer_size().ok_or("the PNG is too large")?;
    let mut samples = vec![0; length];
    let frame = reader.next_frame(&mut samples).map_err(broken)?;
    samples.truncate(frame.buffer_size());
    greys(size, &samples, frame.color_type.samples(), purpose)
}

fn jpeg(bytes: &[u8], purpose: Purpose) -> Result<Greys, String> {
    // The size is checked below, with a sentence that names the remedy.
    let options = DecoderOptions::default()
        .jpeg_set_out_colorspace(ColorSpace::RGB)
        .set_max_width(usize::from(u16::MAX))
        .set_max_height(usize::from(u16::MAX))
        .jpeg_set_max_scans(MOST_SCANS);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    let broken = |error| format!("the JPEG is broken or of a rare kind: {error}; save it as PNG");
    decoder
        .decode_headers()
        .map_err(|error| broken(format!("{error:?}")))?;
    let (width, height) = decoder.dimensions().ok_or("the JPEG has no size")?;
    let size = sized(width, height, purpose)?;
    // The decoder fills what is missing with grey.
    if !has_end(bytes) {
        return Err(INCOMPLETE.into());
    }
    let samples = decoder
        .decode()
        .map_err(|error| broken(format!("{error:?}")))?;
    greys(size, &samples, 3, purpose)
}

/// Whether a JPEG has its last mark, outside the segments, which may hold a smaller picture.
fn has_end(bytes: &[u8]) -> bool {
    let mut rest = bytes.get(2..).unwrap_or_default();
    while let Some(at) = rest.iter().position(|&byte| byte == 0xff) {
        rest = &rest[at + 1..];
        let length = match *rest {
            [0xd9, ..] => return true,
            // A byte of data, a restart, or another byte before a mark.
            [0x00 | 0x01 | 0xd0..=0xd8 | 0xff, ..] => 0,
            [_, high, low, ..] => 1 + usize::from(u16::from_be_bytes([high, low])),
            _ => return false,
        };
        rest = rest.get(length..).unwrap_or_default();
    }
    false
}

/// The size, if it is one for the purpose.
fn sized(width: usize, height: usize, purpose: Purpose) -> Result<[usize; 2], String> {
    let size = format!("the picture has {width} × {height} pixels");
    let shortest = purpose.shortest;
    if width.min(height) == 0 {
        return Err(format!("{size}: save it again"));
    }
    if width.min(height) < shortest {
        return Err(format!(
            "{size}, and {shortest} are needed along each side: take the camera's full size"
        ));
    }
    if width.max(height) > LONGEST {
        return Err(format!(
            "{size}: at most {LONGEST} along a side; scan with fewer dots per inch"
        ));
    }
    let mut pixels = (purpose.pixels)();
    pixels
        .take(width * height)
        .map_err(|over| format!("{size}: {over}"))?;
    Ok([width, height])
}

/// The greys of samples: grey, grey and opacity, colours, or colours and opacity.
fn greys(
    size: [usize; 2],
    samples: &[u8],
    channels: usize,
    purpose: Purpose,
) -> Result<Greys, String> {
    let grey = samples.chunks_exact(channels).map(|pixel| {
        let (colours, opacity) = match *pixel {
            [grey, opacity] => ([grey; 3], opacity),
            [red, green, blue, opacity] => ([red, green, blue], opacity),
            [red, green, blue] => ([red, green, blue], 255),
            _ => ([pixel[0]; 3], 255),
        };
        let dark = u16::from(255 - (purpose.grey)(colours));
        255 - (dark * u16::from(opacity) / 255) as u8
    });
    let grey: Vec<u8> = grey.collect();
    match grey.len() == size[0] * size[1] && !grey.is_empty() {
        true => Ok(Greys { size, grey }),
        false => Err(INCOMPLETE.into()),
    }
}

/// What a file is that is no PNG or JPEG, and what to do.
fn other_format(bytes: &[u8]) -> String {
    let at = |from: usize, wanted: &[u8]| {
        bytes
            .get(from..from + wanted.len())
            .is_some_and(|found| found == wanted)
    };
    let name = if at(4, b"ftyphei") || at(4, b"ftypmif1") || at(4, b"ftyphev") {
        "HEIC picture, as telephones of Apple save them"
    } else if at(4, b"ftypavif") {
        "AVIF picture"
    } else if at(0, b"RIFF") && at(8, b"WEBP") {
        "WebP picture"
    } else if at(0, b"II*\0") || at(0, b"MM\0*") {
        "TIFF or a camera's raw picture"
    } else if at(0, b"GIF8") {
        "GIF picture"
    } else if at(0, b"BM") {
        "BMP picture"
    } else if at(0, b"%PDF") {
        "PDF: the scanner also saves PNG or JPEG"
    } else {
        return "the file is no picture that can be read: give a PNG or a JPEG".into();
    };
    format!("the file is a {name}: save it as PNG or JPEG and give that")
}

#[cfg(test)]
mod tests {
    use super::{Greys, JOB, PHOTOGRAPH, greys, other_format, sized};

    #[test]
    fn ink_of_any_colour_is_dark_and_what_is_not_there_is_paper() {
        let size = [2, 1];
        let grey = |samples: &[u8], channels| greys(size, samples, channels, PHOTOGRAPH);
        let expected = |grey: [u8; 2]| {
            Some(Greys {
                size,
                grey: grey.to_vec(),
            })
        };
        assert_eq!(
            grey(&[255, 0, 0, 250, 255, 240], 3).ok(),
            expected([0, 240])
        );
        assert_eq!(
            grey(&[0, 0, 0, 0, 0, 0, 0, 255], 4).ok(),
            expected([255, 0])
        );
        assert_eq!(grey(&[9, 200], 1).ok(), expected([9, 200]));
        assert_eq!(grey(&[10, 255, 10, 0], 2).ok(), expected([10, 255]));
        assert!(grey(&[9], 1).is_err());
        // To be drawn, red is darker than yellow and brighter than blue.
        let seen = greys([3, 1], &[255, 0, 0, 255, 255, 0, 0, 0, 255], 3, JOB);
        assert_eq!(seen.map(|it| it.grey), Ok(vec![76, 226, 29]));
    }

    #[test]
    fn other_formats_and_sizes_are_named_with_the_remedy() {
        for (start, wanted) in [
            (&b"\0\0\0\x18ftypheic\0\0"[..], "HEIC"),
            (b"RIFF\0\0\0\0WEBPVP8 ", "WebP"),
            (b"%PDF-1.7", "PDF"),
            (b"II*\0\x08", "TIFF"),
            (b"G21\nG0", "give a PNG or a JPEG"),
            (b"", "give a PNG or a JPEG"),
        ] {
            let told = other_format(start);
            assert!(told.contains(wanted) && told.contains("JPEG"), "{told}");
        }
        assert!(sized(4000, 3000, PHOTOGRAPH).is_ok() && sized(4, 2, JOB).is_ok());
        assert!(
            sized(4000, 200, PHOTOGRAPH)
                .unwrap_err()
                .contains("full size")
        );
        assert!(
            sized(50_000, 3000, PHOTOGRAPH)
                .unwrap_err()
                .contains("dots per inch")
        );
    }
}
