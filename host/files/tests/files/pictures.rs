//! Pictures as jobs: drawn shapes whose strokes are known, in pixels with y down.

use crate::placed::AS_WRITTEN;
use fivebar_files::job::{self, Action, Job, JobError, JobOptions, Trace};
use proptest::prelude::*;

pub(crate) type Points = Vec<[f64; 2]>;

/// A PNG in greys of `size` pixels; `dark` gives the darkness at a point, 0 to 1, and each pixel is the mean of `fine`² of them.
pub(crate) fn png([width, height]: [u32; 2], fine: u32, dark: impl Fn([f64; 2]) -> f64) -> Vec<u8> {
    let mut grey = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let part =
                |at: u32, index: u32| f64::from(at) + (f64::from(index) + 0.5) / f64::from(fine);
            let parts =
                (0..fine * fine).map(|index| dark([part(x, index % fine), part(y, index / fine)]));
            let mean = parts.sum::<f64>() / f64::from(fine * fine);
            grey.push((255.0 * (1.0 - mean)).round() as u8);
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder
        .write_header()
        .unwrap()
        .write_image_data(&grey)
        .unwrap();
    bytes
}

pub(crate) fn read(bytes: &[u8], options: &JobOptions) -> Result<Job, JobError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture");
    std::fs::write(&path, bytes).unwrap();
    Job::parse_with(&job::read(&path).unwrap(), &AS_WRITTEN, options)
}

pub(crate) fn by(trace: Trace) -> JobOptions {
    JobOptions {
        trace: Some(trace),
        ..JobOptions::default()
    }
}

/// The strokes of a square picture of `side` pixels.
pub(crate) fn strokes(job: &Job, side: u32) -> Vec<Points> {
    let pixel = 0.1 / f64::from(side);
    let mut strokes: Vec<Points> = Vec::new();
    for step in &job.steps {
        let Action::Line { to: [x, y], .. } = step.action else {
            panic!("{step:?}");
        };
        if !step.draws() {
            strokes.push(Vec::new());
        }
        let point = [x / pixel, f64::from(side) - y / pixel];
        strokes.last_mut().unwrap().push(point);
    }
    strokes
}

fn drawn(
    side: u32,
    fine: u32,
    options: &JobOptions,
    dark: impl Fn([f64; 2]) -> f64,
) -> Vec<Points> {
    strokes(&read(&png([side; 2], fine, dark), options).unwrap(), side)
}

/// Points along strokes, at most a quarter of a pixel apart.
pub(crate) fn along(strokes: &[Points]) -> Points {
    let pairs = strokes.iter().flat_map(|stroke| stroke.windows(2));
    let points = pairs.flat_map(|pair| {
        let [[x, y], [u, v]] = [pair[0], pair[1]];
        let count = (4.0 * (u - x).hypot(v - y)).ceil().max(1.0);
        (0..=count as u32).map(move |step| {
            let share = f64::from(step) / count;
            [x + share * (u - x), y + share * (v - y)]
        })
    });
    points.collect()
}

/// The greatest distance of any point of one set from the other set.
pub(crate) fn hausdorff(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let far = |from: &[[f64; 2]], to: &[[f64; 2]]| {
        let nearest = |p: &[f64; 2]| {
            let distances = to.iter().map(|q| (p[0] - q[0]).hypot(p[1] - q[1]));
            distances.fold(f64::INFINITY, f64::min)
        };
        from.iter().map(nearest).fold(0.0, f64::max)
    };
    far(a, b).max(far(b, a))
}

pub(crate) fn circle([x, y]: [f64; 2], radius: f64) -> Points {
    let angles = (0..1000).map(|step| f64::from(step) / 1000.0 * std::f64::consts::TAU);
    angles
        .map(|angle| [x + radius * angle.cos(), y + radius * angle.sin()])
        .collect()
}

fn length(strokes: &[Points]) -> f64 {
    let pairs = strokes.iter().flat_map(|stroke| stroke.windows(2));
    pairs
        .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]))
        .sum()
}

/// The darkness of a disc.
pub(crate) fn disc([cx, cy]: [f64; 2], radius: f64) -> impl Fn([f64; 2]) -> f64 {
    move |[x, y]| f64::from(u8::from((x - cx).hypot(y - cy) < radius))
}

/// The darkness of a thick line with round ends.
fn thick([from, to]: [[f64; 2]; 2], width: f64) -> impl Fn([f64; 2]) -> f64 {
    let [u, v] = [to[0] - from[0], to[1] - from[1]];
    move |[x, y]| {
        let share = (((x - from[0]) * u + (y - from[1]) * v) / (u * u + v * v)).clamp(0.0, 1.0);
        let [dx, dy] = [x - from[0] - share * u, y - from[1] - share * v];
        f64::from(u8::from(dx.hypot(dy) < 0.5 * width))
    }
}

#[test]
fn outlines_are_within_half_a_pixel_of_the_edge() {
    let middle = [50.3, 49.1];
    // A picture without greys shows an edge within half a pixel's diagonal.
    for (fine, bound) in [(4, 0.3), (1, 0.71)] {
        let found = drawn(100, fine, &by(Trace::Outline), disc(middle, 40.2));
        assert_eq!(found.len(), 1);
        let far = hausdorff(&along(&found), &circle(middle, 40.2));
        assert!(far < bound, "{far} pixels with {fine} × {fine} samples");
        assert_eq!(found[0].first(), found[0].last(), "closed");
    }
    let [outer, inner] = [disc(middle, 40.2), disc(middle, 22.7)];
    let ring = |at| outer(at) - inner(at);
    let found = drawn(100, 4, &by(Trace::Outline), ring);
    let edges = [circle(middle, 40.2), circle(middle, 22.7)].concat();
    assert!(found.len() == 2 && hausdorff(&along(&found), &edges) < 0.3);
    // What the picture's edge cuts is closed along it.
    let all = drawn(40, 1, &by(Trace::Outline), |_| 1.0);
    let frame = along(&[vec![
        [0.0, 0.0],
        [40.0, 0.0],
        [40.0, 40.0],
        [0.0, 40.0],
        [0.0, 0.0],
    ]]);
    let far = hausdorff(&along(&all), &frame);
    assert!(far < 0.5, "{far}");
}

#[test]
fn the_level_moves_the_outline_of_a_slope() {
    // As dark as the share of the way to the right.
    for level in [0.2, 0.5, 0.8] {
        let options = JobOptions {
            level: Some(level),
            ..by(Trace::Outline)
        };
        let found = drawn(100, 1, &options, |[x, _]| x / 100.0);
        let left = found
            .iter()
            .flatten()
            .map(|point| point[0])
            .fold(f64::INFINITY, f64::min);
        assert!((left - 100.0 * level).abs() < 0.5, "{left} at {level}");
    }
}

#[test]
fn centre_lines_are_within_a_pixel_of_the_middle_and_as_long() {
    for (degrees, width) in [
        (0.0, 7.0),
        (13.0, 2.0),
        (45.0, 4.0),
        (80.0, 9.0),
        (90.0, 1.5),
        (130.0, 5.0_f64),
    ] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let ends = [
            [60.2 - 40.0 * cos, 59.9 - 40.0 * sin],
            [60.2 + 40.0 * cos, 59.9 + 40.0 * sin],
        ];
        let found = drawn(120, 4, &by(Trace::CentreLine), thick(ends, width));
        assert_eq!(found.len(), 1, "{degrees}°");
        let across = |[x, y]: &[f64; 2]| ((x - 60.2) * sin - (y - 59.9) * cos).abs();
        let far = found.iter().flatten().map(across).fold(0.0, f64::max);
        assert!(far < 1.0, "{far} pixels at {degrees}°");
        let short = 80.0 - length(&found);
        assert!(
            short.abs() < 0.5 * width + 2.0,
            "{short} pixels short at {degrees}°"
        );
    }
}

#[test]
fn centre_lines_of_a_turned_or_mirrored_picture_are_turned_or_mirrored() {
    let letter = [
        [[20.0, 90.0], [50.0, 20.0]],
        [[50.0, 20.0], [85.0, 95.0]],
        [[35.0, 60.0], [100.0, 57.0]],
    ];
    let lines = letter.map(|ends| thick(ends, 6.0));
    let dark = |at: [f64; 2]| lines.iter().map(|line| line(at)).fold(0.0, f64::max);
    let plain = along(&drawn(120, 4, &by(Trace::CentreLine), dark));
    let mirrored = |[x, y]: [f64; 2]| [120.0 - x, y];
    let turned = |[x, y]: [f64; 2]| [120.0 - x, 120.0 - y];
    for other in [&mirrored as &dyn Fn([f64; 2]) -> [f64; 2], &turned] {
        let found = along(&drawn(120, 4, &by(Trace::CentreLine), |at| dark(other(at))));
        let back: Points = found.into_iter().map(other).collect();
        let far = hausdorff(&back, &plain);
        assert!(far < 2.5, "{far} pixels apart");
    }
    let far = hausdorff(&plain, &along(&letter.map(|ends| ends.to_vec())));
    // Where two lines meet at a corner, thinned ink is up to their width away from the corner.
    assert!(far < 4.5, "{far} pixels from the middle");
}

#[test]
fn a_ring_is_one_closed_line_and_a_cross_is_two() {
    let middle = [60.0, 60.4];
    let [outer, inner] = [disc(middle, 45.0), disc(middle, 38.0)];
    let found = drawn(120, 4, &by(Trace::CentreLine), |at| outer(at) - inner(at));
    assert_eq!(found.len(), 1);
    let far = hausdorff(&along(&found), &circle(middle, 41.5));
    assert!(far < 1.0 && found[0].first() == found[0].last(), "{far}");
    let arms = [[[20.0, 30.0], [100.0, 90.0]], [[20.0, 90.0], [100.0, 30.0]]];
    let [first, second] = arms.map(|ends| thick(ends, 5.0));
    let cross = drawn(120, 4, &by(Trace::CentreLine), |at| {
        first(at).max(second(at))
    });
    assert_eq!(cross.len(), 2, "{cross:?}");
    let dots = drawn(120, 4, &by(Trace::CentreLine), |at| {
        disc([90.0, 30.0], 4.0)(at).max(first(at))
    });
    assert_eq!(dots.len(), 2, "a dot is a short line");
}

#[test]
fn noise_has_centre_lines() {
    let noise = |[x, y]: [f64; 2]| (1e4 * (x * 12.9898 + y * 78.233).sin()).rem_euclid(1.0);
    let found = drawn(100, 1, &by(Trace::CentreLine), noise);
    assert!(found.len() > 100);
    let inside = |at: &f64| (0.0..=100.0).contains(at);
    assert!(found.iter().flatten().flatten().all(inside));
}

#[test]
fn the_share_of_ink_follows_the_tone() {
    // A pen of 1 mm on 100 mm × 100 mm; of the picture, a square of one tone.
    let options = |trace| JobOptions {
        hatch: Some(1e-3),
        ..by(trace)
    };
    for tone in [0.1, 0.25, 0.4, 0.5, 0.65, 0.8, 1.0] {
        let share = |trace| {
            let found = drawn(100, 1, &options(trace), |_| tone);
            match trace {
                Trace::Stipple => found.len() as f64 * std::f64::consts::FRAC_PI_4 / 1e4,
                _ => length(&found) / 1e4,
            }
        };
        let found = share(Trace::Tone);
        assert!((found - tone).abs() < 0.05, "lines: {found} of {tone}");
        let found = share(Trace::Stipple);
        assert!((found - tone).abs() < 0.01, "dots: {found} of {tone}");
        let found = share(Trace::OneLine);
        let bound = if tone > 0.7 { 0.35 } else { 0.1 };
        assert!((found - tone).abs() < bound, "one line: {found} of {tone}");
    }
    let one = drawn(100, 1, &options(Trace::OneLine), |[x, y]| 0.005 * (x + y));
    assert_eq!(one.len(), 1, "the pen stays down");
}

#[test]
fn copies_stand_side_by_side_and_each_pen_draws_all_of_them() {
    let options = JobOptions {
        copies: [3, 2],
        gap: 5e-3,
        ..by(Trace::Outline)
    };
    let shape = disc([50.0, 50.0], 10.0);
    let once = drawn(100, 4, &by(Trace::Outline), &shape);
    let found = drawn(100, 4, &options, &shape);
    assert_eq!(found.len(), 6);
    // A pixel is 1 mm: 20 mm and the gap from one to the next, to the right and up.
    let places = (0..6).map(|index| [25.0 * f64::from(index % 3), -25.0 * f64::from(index / 3)]);
    let expected: Vec<Points> = places
        .flat_map(|[x, y]| {
            once.iter()
                .map(move |stroke| stroke.iter().map(|p| [p[0] + x, p[1] + y]).collect())
        })
        .collect();
    assert!(hausdorff(&along(&found), &along(&expected)) < 0.5);
    let two_pens = "IN;SP1;PU0,0;PD400,0;SP2;PU0,400;PD400,400;SP0;";
    let job = Job::parse_with(two_pens, &AS_WRITTEN, &options).unwrap();
    assert_eq!(job.stops.len(), 1, "each pen draws all copies");
    let refused = Job::parse_with("G1 X1 F100", &AS_WRITTEN, &options).unwrap_err();
    assert!(
        refused.to_string().starts_with("copies are of drawings"),
        "{refused}"
    );
    let all = JobOptions {
        copies: [100, 100],
        hatch: Some(1e-3),
        ..by(Trace::Stipple)
    };
    let refused = read(&png([100, 100], 1, |_| 0.5), &all).unwrap_err();
    assert!(
        refused.to_string().starts_with("the copies are too many"),
        "{refused}"
    );
}

#[test]
fn light_parts_stay_white_and_dark_ones_do_not() {
    let options = JobOptions {
        hatch: Some(1e-3),
        ..by(Trace::Tone)
    };
    let found = drawn(100, 1, &options, |[x, _]| f64::from(u8::from(x > 50.0)));
    let least = found
        .iter()
        .flatten()
        .map(|point| point[0])
        .fold(f64::INFINITY, f64::min);
    assert!((least - 50.0).abs() < 2.0, "{least}");
    let darker = JobOptions {
        level: Some(0.25),
        ..options
    };
    let [plain, darker] = [options, darker].map(|it| length(&drawn(100, 1, &it, |_| 0.25)));
    assert!((plain / 1e4 - 0.25).abs() < 0.05 && (darker / 1e4 - 0.5).abs() < 0.05);
}

#[test]
fn colours_are_as_dark_as_they_look_and_jpegs_are_read() {
    let job = read(include_bytes!("disc.jpg"), &by(Trace::Outline)).unwrap();
    let found = strokes(&job, 64);
    let far = hausdorff(&along(&found), &circle([32.0, 32.0], 20.0));
    assert!(
        found.len() == 1 && far < 1.0,
        "{} strokes, {far}",
        found.len()
    );
    assert!(job.is_drawing);
}

#[test]
fn a_picture_without_a_kind_is_drawn_by_its_outlines_and_what_cannot_be_drawn_is_refused() {
    let bytes = png([60, 60], 1, disc([30.0, 30.0], 20.0));
    let job = read(&bytes, &JobOptions::default()).unwrap();
    let notes: Vec<String> = job.warnings.iter().map(ToString::to_string).collect();
    let expected = "the picture is drawn by its outlines; --picture has outline, centre-line, tone, stipple, one-line";
    assert_eq!(notes, [expected]);
    let pale = read(&png([60, 60], 1, |_| 0.01), &by(Trace::Tone)).unwrap_err();
    assert!(
        pale.to_string().contains("choose a smaller --level"),
        "{pale}"
    );
    let cut = read(&bytes[..bytes.len() / 2], &by(Trace::Outline)).unwrap_err();
    assert!(cut.to_string().contains("the PNG is broken"), "{cut}");
    let fine = JobOptions {
        hatch: Some(1e-5),
        ..by(Trace::Stipple)
    };
    let fine = read(&png([60, 60], 1, |_| 0.9), &fine).unwrap_err();
    assert!(
        fine.to_string().contains("choose a greater --hatch"),
        "{fine}"
    );
}

/// Discs and lines of a random picture of 64 × 64 pixels.
fn shapes() -> impl Strategy<Value = Vec<([[f64; 2]; 2], f64)>> {
    let point = || prop::array::uniform2(10.0..54.0);
    prop::collection::vec((prop::array::uniform2(point()), 2.0..5.0), 1..5)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_picture_that_is_turned_or_mirrored_is_drawn_turned_or_mirrored(shapes in shapes()) {
        let lines: Vec<_> = shapes.iter().map(|&(ends, width)| thick(ends, width)).collect();
        let dark = |at: [f64; 2]| lines.iter().map(|line| line(at)).fold(0.0, f64::max);
        let mirrored = |[x, y]: [f64; 2]| [64.0 - x, y];
        let turned = |[x, y]: [f64; 2]| [y, 64.0 - x];
        let plain = along(&drawn(64, 4, &by(Trace::Outline), dark));
        for other in [&mirrored as &dyn Fn([f64; 2]) -> [f64; 2], &turned] {
            let found = along(&drawn(64, 4, &by(Trace::Outline), |at| dark(other(at))));
            let back: Points = found.into_iter().map(other).collect();
            let far = hausdorff(&back, &plain);
            prop_assert!(far < 0.3, "{} pixels apart", far);
        }
        let ink = |trace, hatch, dark: &dyn Fn([f64; 2]) -> f64| {
            let options = JobOptions { hatch: Some(hatch), ..by(trace) };
            let found = drawn(64, 4, &options, dark);
            match trace { Trace::Stipple => found.len() as f64, _ => length(&found) }
        };
        // Hatching has one direction: along a line that lies in it there is one line of the hatch
        // more or less than across it.
        let along_the_hatch: f64 = shapes.iter().map(|([a, b], _)| (a[0] - b[0]).hypot(a[1] - b[1])).sum();
        for (trace, hatch, least) in [(Trace::Tone, 1e-3, along_the_hatch), (Trace::Stipple, 2e-3, 0.0)] {
            let plain = ink(trace, hatch, &dark);
            let other = ink(trace, hatch, &|at| dark(mirrored(at)));
            prop_assert!((other - plain).abs() < 0.1 * plain + 20.0 + least, "{} and {} with {:?}", plain, other, trace);
        }
    }
}
