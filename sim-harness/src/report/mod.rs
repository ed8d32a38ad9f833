//! Reports: one HTML file that opens offline, with nothing fetched from elsewhere.
//!
//! A [`Page`] is put together from headings, paragraphs, tables, [`Chart`]s, figures and
//! [`Animation`]s, rendered to a string and written by [`write_whole`]. All text is
//! escaped here, so callers pass plain text.

mod animation;
mod chart;
mod decimate;
mod page;
mod quantity;
mod run;
mod write;

pub use animation::{Animation, Body, Trace};
pub use chart::{Chart, Series, Stroke};
pub use page::Page;
pub(crate) use page::escape;
pub use quantity::quantity;
pub use run::RunReport;
pub use write::{WriteError, write_new, write_whole};

/// A point of a chart or of a drawing; a coordinate that is not finite breaks the curve.
pub type Point = [f64; 2];
