//! Hostile pictures that become jobs.

use crate::tables::{jpeg, png, zeros};
use crate::{Input, Kind, counted};
use fivebar_files::job::Trace;

/// Noise in greys, whose every pixel differs from its neighbours.
fn noise(side: usize) -> Vec<u8> {
    let grey = |at: usize| ((at as u32).wrapping_mul(0x9E37_79B1) ^ 0x2C1B_3C6D) >> 7;
    let mixed = |at: usize| (grey(at).wrapping_mul(0x85EB_CA6B) >> 24) as u8;
    let samples: Vec<u8> = (0..side * side).map(mixed).collect();
    encoded(side, &samples)
}

/// A PNG of these greys.
fn encoded(side: usize, samples: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side as u32, side as u32);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(samples).expect("samples");
    drop(writer);
    bytes
}

/// Like a photograph of so many pixels along each side: soft areas of all sizes, and a sensor's noise.
fn photograph(side: usize) -> Vec<u8> {
    let mixed = |at: usize| (at as u32).wrapping_mul(0x9E37_79B1) >> 24;
    let grey = |at: usize| {
        let [x, y] = [at % side, at / side].map(|it| it as f64 / side as f64);
        let wave = |octave: i32| {
            let fine = 3.0 * 2_f64.powi(octave);
            let bent = fine * (x + 0.3 * (4.0 * y + f64::from(octave)).sin());
            bent.sin() * (fine * y).cos() / fine.sqrt()
        };
        let light = 0.5 + 0.4 * (0..7).map(wave).sum::<f64>();
        (255.0 * light + 0.04 * f64::from(mixed(at))).clamp(0.0, 255.0) as u8
    };
    let samples: Vec<u8> = (0..side * side).map(grey).collect();
    encoded(side, &samples)
}

/// Photographs of 1000 × 1000 pixels, which are drawn in each way.
pub(crate) fn photographs() -> Vec<(Kind, usize)> {
    let kind = |trace: Trace| {
        let picture = move || {
            let side = counted(1_000 * 1_000).isqrt();
            Input::Traced(photograph(side), trace)
        };
        let name = format!("large: a photograph by {}", trace.name());
        ((name, Box::new(picture) as Box<dyn Fn() -> Input>), 500)
    };
    Trace::ALL.map(kind).into()
}

pub(crate) fn kinds() -> Vec<Kind> {
    let mut kinds: Vec<Kind> = Vec::new();
    let mut add = |name: String, picture: Box<dyn Fn() -> Vec<u8>>, trace: Trace| {
        let input = move || Input::Traced(picture(), trace);
        kinds.push((format!("drawn: {name}"), Box::new(input)));
    };
    for side in [60_000, 30_000] {
        let picture = move || png([side; 2], &zeros(1 << 20));
        add(
            format!("a PNG of {side}"),
            Box::new(picture),
            Trace::Outline,
        );
    }
    // As many pixels as are drawn at most.
    let side = || counted(6_300 * 6_300).isqrt();
    let picture = move || png([side() as u32; 2], &zeros(side() * (8 * side() + 1)));
    add("a PNG of 6300".into(), Box::new(picture), Trace::Outline);
    let picture = move || jpeg(side() as u16, counted(19));
    add(
        "a JPEG of 6300 with 19 scans".into(),
        Box::new(picture),
        Trace::Tone,
    );
    for trace in Trace::ALL {
        let picture = || noise(counted(1_500 * 1_500).isqrt());
        add(
            format!("noise by {}", trace.name()),
            Box::new(picture),
            trace,
        );
    }
    kinds
}
