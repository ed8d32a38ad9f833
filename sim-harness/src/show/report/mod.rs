//! Reports: one HTML file that opens offline, with nothing fetched from elsewhere.
//!
//! A [`Page`] is put together from headings, paragraphs, tables, [`Chart`]s, figures and
//! [`Animation`]s, and rendered to a string. All text is escaped here, so
//! callers pass plain text.

mod animation;
mod chart;
mod decimate;
mod page;

pub use animation::{Animation, Body, Trace};
pub use chart::{Chart, Series, Stroke};
pub(crate) use decimate::{Range, is_finite, thin};
pub use page::Page;

/// A point of a chart or of a drawing; a coordinate that is not finite breaks the curve.
pub type Point = [f64; 2];
