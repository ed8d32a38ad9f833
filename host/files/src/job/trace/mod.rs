//! Pictures as jobs: PNG and JPEG become strokes.
//!
//! A picture's longer side is 100 mm at scale 1, because pixels have no size of their own. Ink is what is darker than the level,
//! as a share between white and black.

mod centre_line;
mod contour;
pub(super) mod data_uri;
mod dots;
mod forks;
mod kind;
mod raster;
mod simplify;
mod tone;

use super::drawing::{self, Pen, Stroke};
use super::order::Order;
use super::{Job, JobError, JobOptions, Placement, Warning, WarningKind};
use crate::OverBudget;
use crate::picture::greys_to_draw;
use raster::Raster;

pub use kind::Trace;

/// The longer side of a picture at scale 1 [m].
const LONGER_SIDE: f64 = 0.1;
/// The pen's width where none is stated [m].
const PEN: f64 = 5e-4;

/// The job that draws a picture.
pub(super) fn interpret(
    text: &str,
    placement: &Placement,
    options: &JobOptions,
) -> Result<Job, JobError> {
    let bytes = data_uri::bytes(text).map_err(JobError::Drawing)?;
    let picture = greys_to_draw(&bytes).map_err(JobError::Drawing)?;
    drop(bytes);
    let (raster, shrunk) = Raster::of(&picture);
    drop(picture);
    if raster.is_white() {
        let reason = "the picture is white everywhere: is it the right file?";
        return Err(JobError::Drawing(reason.into()));
    }
    let mut notes = Vec::new();
    let mut note = |what: String| notes.push(Warning::at(0, WarningKind::Drawing(what.into())));
    if options.trace.is_none() {
        let names = Trace::ALL.map(Trace::name).join(", ");
        note(format!(
            "the picture is drawn by its outlines; --picture has {names}"
        ));
    }
    if shrunk > 1 {
        note(format!(
            "the picture is traced with 1 of {shrunk} pixels along each side"
        ));
    }
    let pixel = LONGER_SIDE / raster.width().max(raster.height()) as f64;
    let pen = options.hatch.unwrap_or(PEN) / pixel;
    let strokes = traced(
        &raster,
        options.trace.unwrap_or_default(),
        options.level,
        pen,
    );
    let strokes =
        strokes.map_err(|over| JobError::Drawing(format!("the picture is too fine: {over}")))?;
    if strokes.is_empty() {
        let reason = "the picture has nothing dark enough, larger than 3 pixels and wider than the pen: choose a smaller \
                      --level or --hatch, or save it with more pixels";
        return Err(JobError::Drawing(reason.into()));
    }
    let height = raster.height() as f64;
    let metres = |[x, y]: [f64; 2]| [pixel * x, pixel * (height - y)];
    let strokes: Vec<Stroke> = strokes
        .into_iter()
        .map(|it| it.into_iter().map(metres).collect())
        .collect();
    let name = String::new();
    drawing::job(vec![Pen { name, strokes }], notes, placement, options)
}

/// The strokes of a picture, in pixels from the upper left corner of its first one; `pen` is the pen's width.
fn traced(
    raster: &Raster,
    trace: Trace,
    level: Option<f64>,
    pen: f64,
) -> Result<Vec<Stroke>, OverBudget> {
    let threshold = || level.unwrap_or_else(|| raster.middle_level()) as f32;
    let toned = || raster.with_half_ink_at(level.unwrap_or(0.5));
    match trace {
        Trace::Outline => contour::outlines(raster, threshold()),
        Trace::CentreLine => centre_line::strokes(raster, threshold()),
        Trace::Tone => tone::lines(&toned(), pen),
        Trace::Stipple => dots::stipple(&toned(), pen),
        Trace::OneLine => {
            let dots = dots::for_one_line(&toned(), pen)?;
            let dots = dots.into_iter().map(|dot| vec![dot]).collect();
            let line = Order::default().sorted(dots, [0.0; 2]).concat();
            Ok(vec![line].into_iter().filter(|it| it.len() > 1).collect())
        }
    }
}
