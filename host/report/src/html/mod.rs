//! Reports: each is one HTML file that works offline and loads no other file.
//!
//! A [`Page`] consists of headings, paragraphs, tables, [`Chart`]s, figures and [`Animation`]s,
//! and is rendered to a string. Callers pass plain text; it is escaped here.

mod animation;
mod bands;
mod bars;
mod chart;
mod decimate;
mod page;
mod uplot;

pub use animation::{AnimatedBody, AnimatedTrace, Animation};
pub use bands::BANDS;
pub use bars::{Bar, bars};
pub use chart::{Chart, Series, Stroke};
pub(crate) use decimate::{BoundingBox, is_finite, thin};
pub use page::Page;
pub use uplot::{UPLOT_SCRIPT, UPLOT_STYLE};

/// A point of a chart or a drawing. A point with a coordinate that is not finite is a gap in the
/// curve.
pub type Point = [f64; 2];
