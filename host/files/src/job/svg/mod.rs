//! SVG drawings as jobs: the outlines of all visible shapes, in true size, and on demand their fills as lines.
//!
//! The crate `usvg` resolves styles, units, transforms, references and texts, so that only lines
//! and Bézier curves are left. Their points become metres with y up and (0, 0) in the lower left
//! corner of the page. Curves are flattened, and the strokes are sorted for short travel between
//! them. The tool is down along strokes; widths of lines are not drawn, and fills only as hatches.

mod flatten;
mod hatch;
mod markup;
mod outlines;
mod pens;
mod size;
mod texts;

use super::drawing::{self, Stroke};
use super::{Job, JobError, JobOptions, Placement, Step, Warning, WarningKind};
use crate::budget::{MOST_NODES, OverBudget};
use crate::lettering::drawn_once;
use flatten::Flattener;
use hatch::Hatch;
use pens::Pens;
use std::borrow::Cow;
use texts::Fonts;
use usvg::{Group, Node, Transform};

/// Metres per pixel: an inch has 96 pixels in SVG.
const PIXEL: f64 = 25.4e-3 / 96.0;

/// Stack for the thread that reads a drawing: usvg calls itself for each level of nested groups, of
/// which there are up to a thousand.
const STACK: usize = 64 << 20;

/// Reads a drawing in a thread of its own.
pub(super) fn interpret(
    text: &str,
    placement: &Placement,
    options: &JobOptions,
) -> Result<Job, JobError> {
    let unread = |reason: String| JobError::Drawing(format!("the SVG cannot be read: {reason}"));
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK);
        let reader = thread.spawn_scoped(scope, || drawn(text, placement, options));
        let reader = reader.map_err(|error| unread(error.to_string()))?;
        let job = reader.join();
        job.unwrap_or_else(|_| Err(unread("its reader failed".into())))
    })
}

fn drawn(text: &str, placement: &Placement, options: &JobOptions) -> Result<Job, JobError> {
    if let Some(reason) = markup::refusal(text) {
        return Err(JobError::Drawing(reason));
    }
    let parsing = usvg::roxmltree::ParsingOptions {
        allow_dtd: true,
        nodes_limit: MOST_NODES,
        ..Default::default()
    };
    let document = usvg::roxmltree::Document::parse_with_options(text, parsing)
        .map_err(|error| unread(&usvg::Error::ParsingFailed(error)))?;
    if let Some(reason) = size::refusal(&document) {
        return Err(JobError::Drawing(reason));
    }
    let fonts = Fonts::new();
    let (tree, without_width) = outlines::tree(&document, &fonts)?;
    let mut reader = Reader {
        height: f64::from(tree.size().height()),
        flattener: Flattener::new(options.tolerance / PIXEL),
        hatch: options.hatch.map(Hatch::new),
        pens: Pens::new(&document),
        is_covered: false,
        is_text: false,
        fonts,
        notes: Vec::new(),
    };
    if text.contains("<image") {
        reader.note("images are left out: a tool draws lines only");
    }
    if without_width > 0 {
        reader.note("lines of no width are left out, as viewers leave them out: give them a width");
    }
    reader.group(tree.root())?;
    let hatch = reader.hatch.take().into_iter();
    for (fill, line) in hatch.flat_map(Hatch::into_lines) {
        reader.pens.add_line(fill, line);
    }
    let (pens, has_many_colours) = reader.pens.into_pens();
    if has_many_colours {
        let what = "the lines have more colours than pens: all are drawn with one";
        let kind = WarningKind::Drawing(what.into());
        reader.notes.push(Warning::at(0, kind));
    }
    let job = drawing::job(pens, reader.notes, placement, options)?;
    if job.steps.iter().any(Step::draws) {
        return Ok(job);
    }
    let notes = job.warnings.iter().map(|note| format!("; {note}"));
    let notes = notes.collect::<String>();
    Err(JobError::Drawing(format!(
        "the SVG has no visible lines, shapes or texts to draw{notes}"
    )))
}

struct Reader {
    /// The page's height [px].
    height: f64,
    flattener: Flattener,
    hatch: Option<Hatch>,
    pens: Pens,
    /// Whether a group around the present one is transparent, or is cut by a clip or a mask.
    is_covered: bool,
    /// Whether the present group is a text.
    is_text: bool,
    fonts: Fonts,
    notes: Vec<Warning>,
}

impl Reader {
    fn group(&mut self, group: &Group) -> Result<(), JobError> {
        let is_cut = group.clip_path().is_some() || group.mask().is_some();
        if is_cut {
            self.note("clips and masks do not cut the lines");
        }
        if group.opacity().get() == 0.0 {
            return Ok(());
        }
        let was_covered = self.is_covered;
        self.is_covered |= is_cut || group.opacity().get() < 1.0;
        let outside = self.pens.enter(group.id());
        for node in group.children() {
            match node {
                Node::Group(group) => self.group(group)?,
                Node::Path(path) if is_seen(path) => self.path(path)?,
                Node::Text(text) => {
                    for note in self.fonts.notes(text) {
                        self.note(note);
                    }
                    self.is_text = true;
                    self.group(text.flattened())?;
                    self.is_text = false;
                }
                Node::Path(_) | Node::Image(_) => {}
            }
        }
        self.pens.leave(outside);
        self.is_covered = was_covered;
        Ok(())
    }

    fn path(&mut self, path: &usvg::Path) -> Result<(), JobError> {
        if path.stroke().is_some_and(|it| it.dasharray().is_some()) {
            self.note("dashed lines are drawn whole");
        }
        let Transform {
            sx,
            kx,
            ky,
            sy,
            tx,
            ty,
        } = path.abs_transform();
        let [sx, kx, ky, sy, tx, ty] = [sx, kx, ky, sy, tx, ty].map(f64::from);
        let height = self.height;
        let place = |point: usvg::tiny_skia_path::Point| {
            let [x, y] = [point.x, point.y].map(f64::from);
            [sx * x + kx * y + tx, height - (ky * x + sy * y + ty)]
        };
        let strokes = self.flattener.strokes(path.data().segments(), place);
        let strokes = strokes.map_err(too_large)?;
        let metres = |point: [f64; 2]| point.map(|pixels| pixels * PIXEL);
        let strokes: Vec<Stroke> = strokes
            .into_iter()
            .map(|it| it.into_iter().map(metres).collect())
            .collect();
        if let (Some(hatch), Some(fill)) = (&mut self.hatch, path.fill()) {
            let number = is_ink(fill).then(|| self.pens.of_fill(fill));
            let is_opaque = fill.opacity().get() == 1.0
                && !self.is_covered
                && !matches!(fill.paint(), usvg::Paint::Pattern(_));
            hatch
                .fill(&strokes, fill.rule(), number, is_opaque)
                .map_err(too_large)?;
        }
        if !self.is_left_white(path) {
            let strokes = match self.is_text {
                true => strokes.into_iter().filter_map(drawn_once).collect(),
                false => strokes,
            };
            self.pens.add(path, strokes);
        }
        Ok(())
    }

    /// Whether a hatch leaves the whole path white, as the page is.
    fn is_left_white(&self, path: &usvg::Path) -> bool {
        let has_line = path.stroke().is_some_and(|it| it.opacity().get() > 0.0);
        self.hatch.is_some() && !has_line && !path.fill().is_some_and(is_ink)
    }

    fn note(&mut self, what: impl Into<Cow<'static, str>>) {
        let kind = WarningKind::Drawing(what.into());
        match self.notes.iter_mut().find(|note| note.kind == kind) {
            Some(same) => same.count += 1,
            None => self.notes.push(Warning::at(0, kind)),
        }
    }
}

fn unread(error: &usvg::Error) -> JobError {
    JobError::Drawing(format!("the file is no SVG that can be read: {error}"))
}

fn too_large(over: OverBudget) -> JobError {
    JobError::Drawing(format!("the SVG is too large: {over}"))
}

/// Whether a fill is seen on white paper.
fn is_ink(fill: &usvg::Fill) -> bool {
    let is_white =
        matches!(fill.paint(), usvg::Paint::Color(colour) if *colour == usvg::Color::white());
    fill.opacity().get() > 0.0 && !is_white
}

/// Whether a path has a fill or a stroke that is not transparent.
fn is_seen(path: &usvg::Path) -> bool {
    let fill = path.fill().map(usvg::Fill::opacity);
    let stroke = path.stroke().map(usvg::Stroke::opacity);
    let mut opacities = fill.into_iter().chain(stroke);
    path.is_visible() && opacities.any(|opacity| opacity.get() > 0.0)
}
