//! The comparison: marks, lens, strokes.

use super::error::PhotoError;
use super::marks::{self, MARK_STEP};
use super::picture::Picture;
use super::profile::ink_middle;
use super::samples::{SPACING, Sample, length, samples};
use super::scales::{Scales, scales};
use super::view::{LENS, View};
use nalgebra::{Isometry2, Matrix3, Point2, Translation2, Vector2, Vector3};
use std::f64::consts::TAU;

/// The distortion k of the lens, with the radius in halves of the picture's diagonal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Found from the strokes.
    Unknown,
    /// As a camera's calibration has it; 0 for a scanner.
    Known(f64),
}

/// What is compared.
#[derive(Clone, Copy, Debug)]
pub struct Photograph<'a> {
    /// The picture.
    pub picture: &'a Picture,
    /// The strokes of the job, each as a line through points [m].
    pub strokes: &'a [Vec<Vector2<f64>>],
    /// The centres of the marks as their job has them [m]; the first one is that with three circles.
    pub marks: [Vector2<f64>; 4],
    /// Where they were measured to be [m], in the same order. The placement of the drawing on the paper is
    /// then taken as that with the least errors.
    pub measured: Option<[Vector2<f64>; 4]>,
    /// The lens.
    pub lens: Lens,
    /// How far from its place ink is searched, to each side [m].
    pub window: f64,
}

/// How far a stroke lies beside its place at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// The stroke, from 0.
    pub stroke: usize,
    /// The piece of the stroke between two of its points, from 0.
    pub piece: usize,
    /// The point of the job [m].
    pub place: Vector2<f64>,
    /// The unit vector to the left of the stroke.
    pub normal: Vector2<f64>,
    /// How far the ink lies from the point along the normal [m].
    pub error: f64,
}

/// A photograph compared with a job.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The points, along the strokes in their order, 0.5 mm apart; those that are near other ink and those
    /// without ink are missing.
    pub deviations: Vec<Deviation>,
    /// Root mean square of the errors [m].
    pub rms: f64,
    /// The length of the job's strokes [m].
    pub drawn: f64,
    /// The length of those that have been measured [m].
    pub measured: f64,
    /// The distortion k of the lens.
    pub lens: f64,
    /// How far the lens moves a point of the strokes at most [m].
    pub lens_shift: f64,
    /// Of the drawing; none where the marks were not measured, because they hide them.
    pub scales: Option<Scales>,
    /// The greatest length on the paper that a pixel shows in the middle of the marks [m].
    pub pixel: f64,
    view: View,
}

impl Comparison {
    /// The greatest error.
    pub fn greatest(&self) -> Option<&Deviation> {
        let size = |deviation: &&Deviation| deviation.error.abs();
        self.deviations
            .iter()
            .max_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// The pixel at which a lens without distortion would show a point of the paper [m].
    pub fn pixel_of(&self, place: Vector2<f64>) -> Option<Vector2<f64>> {
        self.view.straight_pixel(place)
    }
}

/// Fewest pixels per millimetre at which marks and strokes are found.
const COARSEST: f64 = 4.0;
/// Least share of the strokes' points that must be found.
const FOUND: f64 = 0.4;
/// Points of the strokes from which the lens is found.
const LENS_POINTS: usize = 1500;
/// Step between the distortions that are tried first: it moves a point by less than half a window.
const LENS_STEP: f64 = 4e-3;
/// How often the placement is taken away and the strokes are measured again. A stroke of radius r that is moved by s
/// along itself seems to lie s²/(2r) aside, so the errors of a moved drawing are not those plus n·a.
const PLACEMENTS: usize = 3;
/// Neighbours of a point along its stroke, to each side.
const NEAR: usize = 2;
/// An error that is farther outside of those of its neighbours is of a speck [m].
const SPECK: f64 = 0.1e-3;

type Pairs = [(Vector2<f64>, Vector2<f64>); 4];

/// Compares a photograph with a job.
///
/// # Errors
/// The marks are not found, or the strokes are not where they should be.
pub fn compare(photo: &Photograph<'_>) -> Result<Comparison, PhotoError> {
    let mut pairs = seen_marks(photo)?;
    let samples = samples(photo.strokes, photo.window);
    if samples.is_empty() {
        return Err(PhotoError::NoSamples);
    }
    let every = samples.len().div_ceil(LENS_POINTS);
    let few: Vec<Sample> = samples.iter().step_by(every).copied().collect();
    let mut lens = match photo.lens {
        Lens::Known(lens) => lens,
        Lens::Unknown => first_lens(photo, &pairs, &few),
    };
    for _ in 0..2 {
        pairs = centred(photo, &pairs, lens).ok_or(PhotoError::View)?;
        if photo.lens == Lens::Unknown {
            lens = better_lens(photo, &pairs, &few, lens);
        }
    }
    // The marks are a part of the drawing, so the lens is found with them as drawn: a drawing that is too
    // wide, with its marks, is not taken for a lens.
    if let Some(measured) = photo.measured {
        let measured = in_turn(measured);
        pairs = [0, 1, 2, 3].map(|index| (measured[index], pairs[index].1));
    }
    let measure = |pairs: &Pairs| {
        let view = View::through(photo.picture.size(), pairs, lens).ok_or(PhotoError::View)?;
        let found = without_specks(&errors(photo, &view, &samples));
        let share = found.len() as f64 / samples.len() as f64;
        if share < FOUND {
            return Err(PhotoError::OtherJob(share));
        }
        Ok((view, found))
    };
    let (mut view, mut deviations) = measure(&pairs)?;
    if photo.measured.is_some() {
        for _ in 0..PLACEMENTS {
            let Some(back) = without_placement(&deviations) else {
                break;
            };
            for (place, _) in &mut pairs {
                *place = (back * Point2::from(*place)).coords;
            }
            (view, deviations) = measure(&pairs)?;
        }
    }
    let squares: f64 = deviations.iter().map(|d| d.error * d.error).sum();
    let straight = View::through(photo.picture.size(), &pairs, 0.0).ok_or(PhotoError::View)?;
    let shift = |d: &Deviation| Some((straight.place(view.pixel(d.place)?)? - d.place).norm());
    let middle = 0.25 * photo.marks.iter().sum::<Vector2<f64>>();
    Ok(Comparison {
        rms: (squares / deviations.len() as f64).sqrt(),
        drawn: length(photo.strokes),
        measured: SPACING * deviations.len() as f64,
        lens,
        lens_shift: deviations.iter().filter_map(shift).fold(0.0, f64::max),
        scales: photo.measured.and_then(|_| scales(&deviations)),
        pixel: view.pixel_size(middle).ok_or(PhotoError::View)?,
        deviations,
        view,
    })
}

/// The marks on the paper with their pixels. From the first mark on, the others follow counter-clockwise
/// on the paper, and in the picture, whose y is down, clockwise by its angles.
fn seen_marks(photo: &Photograph<'_>) -> Result<Pairs, PhotoError> {
    let seen = marks::find(photo.picture);
    let firsts = seen.iter().filter(|mark| mark.is_first).count();
    let (Ok(mut seen), 1) = (<[_; 4]>::try_from(&seen[..]), firsts) else {
        return Err(PhotoError::Marks(seen.len(), firsts));
    };
    let radius = seen.iter().map(|mark| mark.radius);
    let per_millimetre = radius.fold(f64::INFINITY, f64::min) / (1e3 * MARK_STEP);
    if per_millimetre < COARSEST {
        return Err(PhotoError::Coarse(per_millimetre));
    }
    let first = seen.iter().position(|mark| mark.is_first).unwrap_or(0);
    seen.swap(0, first);
    let pixels = in_turn(seen.map(|mark| mark.centre.component_mul(&Vector2::new(1.0, -1.0))));
    let pixels = pixels.map(|pixel| pixel.component_mul(&Vector2::new(1.0, -1.0)));
    let places = in_turn(photo.marks);
    Ok([0, 1, 2, 3].map(|index| (places[index], pixels[index])))
}

/// The points, the first one first, the others counter-clockwise from it about the middle of all.
fn in_turn(mut points: [Vector2<f64>; 4]) -> [Vector2<f64>; 4] {
    let middle = 0.25 * points.iter().sum::<Vector2<f64>>();
    let angle = |point: Vector2<f64>| (point.y - middle.y).atan2(point.x - middle.x);
    let first = angle(points[0]);
    let turn = |point: &Vector2<f64>| (angle(*point) - first).rem_euclid(TAU);
    points[1..].sort_by(|a, b| turn(a).total_cmp(&turn(b)));
    points
}

/// The marks with their centres from the ink of their circles: each point of a circle is off by
/// n·d + Δr, with the centre's error d and the radius's error Δr.
fn centred(photo: &Photograph<'_>, pairs: &Pairs, lens: f64) -> Option<Pairs> {
    let view = View::through(photo.picture.size(), pairs, lens)?;
    let mut better = *pairs;
    for (place, pixel) in &mut better {
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for circle in [1.0, 2.0] {
            for step in 0..72 {
                let (sin, cos) = (TAU * f64::from(step) / 72.0).sin_cos();
                let out = Vector2::new(cos, sin);
                let point = *place + out * (circle * MARK_STEP);
                let ink = ink_middle(photo.picture, &view, [point, out], 0.49 * MARK_STEP);
                if let Some(off) = ink {
                    let row = Vector3::new(cos, sin, 1.0);
                    normal += row * row.transpose();
                    right += row * off;
                }
            }
        }
        if let Some(found) = normal.cholesky().map(|factor| factor.solve(&right)) {
            *pixel = view.pixel(*place + found.xy())?;
        }
    }
    Some(better)
}

/// The errors of the samples in this view.
fn errors(photo: &Photograph<'_>, view: &View, samples: &[Sample]) -> Vec<Option<Deviation>> {
    let error = |sample: &Sample| {
        let across = [sample.place, sample.normal];
        let error = ink_middle(photo.picture, view, across, photo.window)?;
        Some(Deviation {
            stroke: sample.stroke,
            piece: sample.piece,
            place: sample.place,
            normal: sample.normal,
            error,
        })
    };
    samples.iter().map(error).collect()
}

/// How badly the strokes fit with this lens: the mean of min(t²/T², 1), where no ink counts 1. T is the
/// window.
fn misfit(photo: &Photograph<'_>, pairs: &Pairs, few: &[Sample], lens: f64) -> f64 {
    let Some(view) = View::through(photo.picture.size(), pairs, lens) else {
        return 1.0;
    };
    let found = errors(photo, &view, few);
    let cost = found.iter().map(|found| match found {
        Some(found) => (found.error / photo.window).powi(2).min(1.0),
        None => 1.0,
    });
    cost.sum::<f64>() / few.len() as f64
}

/// The best of the distortions at equal steps.
fn first_lens(photo: &Photograph<'_>, pairs: &Pairs, few: &[Sample]) -> f64 {
    let count = ((LENS[1] - LENS[0]) / LENS_STEP).round() as i32;
    let tried = (0..=count).map(|step| LENS[0] + LENS_STEP * f64::from(step));
    let judged = tried.map(|lens| (lens, misfit(photo, pairs, few, lens)));
    let best = judged.min_by(|a, b| a.1.total_cmp(&b.1));
    best.map_or(0.0, |(lens, _)| lens)
}

/// The best distortion near this one, by golden section.
fn better_lens(photo: &Photograph<'_>, pairs: &Pairs, few: &[Sample], lens: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let (mut low, mut high) = (lens - LENS_STEP, lens + LENS_STEP);
    let cost = |lens| misfit(photo, pairs, few, lens);
    let [mut a, mut b] = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let [mut at_a, mut at_b] = [a, b].map(cost);
    // 0.618¹⁴ of the step moves no point by more than a micrometre.
    for _ in 0..14 {
        if at_a < at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - GOLDEN * (high - low);
            at_a = cost(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + GOLDEN * (high - low);
            at_b = cost(b);
        }
    }
    0.5 * (low + high)
}

/// The errors that were found, without those that lie outside of what their neighbours along the stroke have,
/// such as at a speck, and without those that have no neighbours.
fn without_specks(found: &[Option<Deviation>]) -> Vec<Deviation> {
    let smooth = found.iter().enumerate().filter_map(|(index, own)| {
        let own = (*own)?;
        let first = index.saturating_sub(NEAR);
        let near = found[first..(index + NEAR + 1).min(found.len())]
            .iter()
            .flatten();
        let beside = near.filter(|other| {
            let away = (other.place - own.place).norm();
            other.stroke == own.stroke && away > 0.0 && away < (NEAR as f64 + 0.5) * SPACING
        });
        let [low, high] = beside.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], other| {
            [low.min(other.error), high.max(other.error)]
        });
        (low - SPECK <= own.error && own.error <= high + SPECK).then_some(own)
    });
    smooth.collect()
}

/// The motion of the whole drawing by a translation and a turn that makes the errors least: the least squares
/// of t − n·(a + φ Jq), taken back. None if the strokes do not determine it.
fn without_placement(found: &[Deviation]) -> Option<Isometry2<f64>> {
    let mean = found.iter().map(|d| d.place).sum::<Vector2<f64>>() / found.len() as f64;
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for deviation in found {
        let (n, q) = (deviation.normal, deviation.place - mean);
        let row = Vector3::new(n.x, n.y, n.y * q.x - n.x * q.y);
        normal += row * row.transpose();
        right += row * deviation.error;
    }
    let placement = normal.cholesky()?.solve(&right);
    Some(Isometry2::new(mean - placement.xy(), -placement.z) * Translation2::from(-mean))
}
