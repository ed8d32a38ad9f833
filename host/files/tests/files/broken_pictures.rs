//! Pictures as they also come: each becomes strokes, or is refused with what to do.

use crate::pictures::{along, circle, disc, hausdorff, png, read, strokes};
use fivebar_files::job::{Job, JobError, JobOptions, Trace};

/// The sentences of the refusals name one of these remedies.
const REMEDIES: [&str; 6] = [
    "choose a smaller --level",
    "is it the right file?",
    "copy it or save it again",
    "save it",
    "give a PNG or a JPEG",
    "fewer dots per inch",
];

/// With a pen of 2 mm: dots are few.
fn by(trace: Trace) -> JobOptions {
    JobOptions {
        hatch: Some(2e-3),
        ..crate::pictures::by(trace)
    }
}

/// Whether there are strokes; or else the refusal, which names a remedy and no option of a library.
fn drawn_or_refused(name: &str, found: &Result<Job, JobError>) -> Option<String> {
    let Err(error) = found else {
        assert!(found.iter().all(|job| !job.steps.is_empty()), "{name}");
        return None;
    };
    let said = error.to_string();
    assert!(
        REMEDIES.iter().any(|it| said.contains(it)),
        "{name}: {said}"
    );
    assert!(!said.contains("set_limits"), "{name}: {said}");
    Some(said)
}

/// A disc of radius 20 in 64 × 64 pixels, whose samples `of` makes of its darkness.
fn encoded(color: png::ColorType, depth: png::BitDepth, of: impl Fn(f64) -> Vec<u8>) -> Vec<u8> {
    let dark = disc([32.0, 32.0], 20.0);
    let place = |at: usize| [(at % 64) as f64 + 0.5, (at / 64) as f64 + 0.5];
    let samples: Vec<u8> = (0..64 * 64).flat_map(|at| of(dark(place(at)))).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 64, 64);
    encoder.set_color(color);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&samples).unwrap();
    writer.finish().unwrap();
    bytes
}

/// A PNG whose header states another size.
fn with_size(mut bytes: Vec<u8>, size: [u32; 2]) -> Vec<u8> {
    bytes[16..20].copy_from_slice(&size[0].to_be_bytes());
    bytes[20..24].copy_from_slice(&size[1].to_be_bytes());
    let mut sum = flate2::Crc::new();
    sum.update(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&sum.sum().to_be_bytes());
    bytes
}

/// A JPEG whose frame states another size.
fn jpeg_with_size(bytes: &[u8], size: [u16; 2]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let frame = bytes.windows(2).position(|pair| pair == [0xff, 0xc0]);
    let frame = frame.expect("a frame");
    bytes[frame + 5..frame + 7].copy_from_slice(&size[1].to_be_bytes());
    bytes[frame + 7..frame + 9].copy_from_slice(&size[0].to_be_bytes());
    bytes
}

#[test]
fn every_kind_of_samples_is_drawn_alike() {
    use png::BitDepth::{Eight, Sixteen};
    use png::ColorType::{Grayscale, GrayscaleAlpha, Rgba};
    let level = |dark: f64, most: f64| most * (1.0 - dark);
    let pictures = [
        (
            "16 bits",
            encoded(Grayscale, Sixteen, |dark| {
                (level(dark, 65_535.0) as u16).to_be_bytes().to_vec()
            }),
        ),
        // The disc is what is opaque.
        (
            "grey and opacity",
            encoded(GrayscaleAlpha, Eight, |dark| {
                vec![0, level(1.0 - dark, 255.0) as u8]
            }),
        ),
        (
            "16 bits in colour with opacity",
            encoded(Rgba, Sixteen, |dark| {
                let colour = (level(dark, 65_535.0) as u16).to_be_bytes();
                [colour, colour, colour, [255, 255]].concat()
            }),
        ),
        (
            "inks of four colours",
            include_bytes!("disc_cmyk.jpg").to_vec(),
        ),
    ];
    for (name, bytes) in pictures {
        let job = read(&bytes, &by(Trace::Outline)).unwrap();
        let found = strokes(&job, 64);
        assert_eq!(found.len(), 1, "{name}");
        let far = hausdorff(&along(&found), &circle([32.0, 32.0], 20.0));
        assert!(far < 1.0, "{name}: {far} pixels");
        for trace in Trace::ALL {
            let refused = drawn_or_refused(name, &read(&bytes, &by(trace)));
            assert_eq!(refused, None, "{name}");
        }
    }
}

#[test]
fn a_picture_that_is_cut_is_refused_wherever_it_is_cut() {
    let pictures = [
        ("PNG", png([64, 64], 1, disc([32.0, 32.0], 20.0))),
        ("JPEG", include_bytes!("disc.jpg").to_vec()),
        (
            "JPEG of four inks",
            include_bytes!("disc_cmyk.jpg").to_vec(),
        ),
    ];
    for (name, bytes) in pictures {
        // A PNG is complete before its last chunk, of 12 bytes, and a JPEG's last mark has two.
        let last = bytes.len() - if name == "PNG" { 12 + 4 } else { 1 };
        for length in (4..last).step_by(31).chain([last]) {
            let found = read(&bytes[..length], &by(Trace::Outline));
            let refused = drawn_or_refused(&format!("{name} of {length} bytes"), &found);
            assert!(refused.is_some(), "{name} of {length} of {}", bytes.len());
        }
        let more = [&bytes[..], &[0; 100]].concat();
        assert!(read(&more, &by(Trace::Outline)).is_ok(), "{name}");
    }
}

#[test]
fn a_picture_without_pixels_or_with_too_many_is_refused_before_memory_is_taken() {
    let plain = png([2, 2], 1, |_| 1.0);
    let jpeg = include_bytes!("disc.jpg");
    for (name, bytes, wanted) in [
        (
            "PNG",
            with_size(plain.clone(), [0, 0]),
            "copy it or save it again",
        ),
        ("JPEG", jpeg_with_size(jpeg, [0, 0]), "save it"),
        (
            "PNG",
            with_size(plain.clone(), [60_000; 2]),
            "at most 40000",
        ),
        ("JPEG", jpeg_with_size(jpeg, [60_000; 2]), "at most 40000"),
        (
            "PNG",
            with_size(plain.clone(), [30_000; 2]),
            "40000000 pixels",
        ),
        ("JPEG", jpeg_with_size(jpeg, [30_000; 2]), "40000000 pixels"),
        ("PNG", with_size(plain, [4_000_000_000, 1]), "fewer pixels"),
    ] {
        for trace in Trace::ALL {
            let refused = drawn_or_refused(name, &read(&bytes, &by(trace))).unwrap();
            assert!(refused.contains(wanted), "{name}: {refused}");
        }
    }
}

#[test]
fn the_smallest_the_white_and_the_black_picture_are_drawn_or_refused() {
    for size in [[1, 1], [2, 1], [1, 300], [300, 1], [60, 60]] {
        for trace in Trace::ALL {
            let name = format!("{size:?} by {}", trace.name());
            let white = drawn_or_refused(&name, &read(&png(size, 1, |_| 0.0), &by(trace)));
            let white = white.expect("a refusal");
            assert!(white.contains("white everywhere"), "{name}: {white}");
            let black = drawn_or_refused(&name, &read(&png(size, 1, |_| 1.0), &by(trace)));
            // A line of pixels can be narrower than the pen.
            assert!(black.is_none() || size != [60, 60], "{name}: {black:?}");
        }
    }
}
