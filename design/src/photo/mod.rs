//! A photograph or a scan of a finished drawing, compared with the job.
//!
//! Four marks on the paper give the perspective, the strokes themselves the distortion of the lens. Then the
//! ink across each stroke gives how far the stroke lies beside its place, to the left of its direction
//! positive. Along a stroke nothing can be seen.
//!
//! *What cannot be seen.* Marks that the arm drew are off by the arm's own error at their places. What moves
//! four points — a translation, a turn, two scales, a shear and two tilts, eight numbers — is then not in
//! the result. With measured distances of the marks ([`measured_marks`]) only the placement of the whole drawing,
//! three numbers, is not. And what an error has in common with the distortion of a lens is taken for that,
//! unless the lens is known ([`Lens::Known`]).

mod compare;
mod distances;
mod error;
mod local;
mod marks;
mod picture;
mod profile;
mod samples;
mod scales;
mod view;

pub use compare::{Comparison, Deviation, Lens, Photograph, compare};
pub use distances::{MarkDistance, measured_marks};
pub use error::PhotoError;
pub use local::{LocalPoint, local_points};
pub use marks::MARK_STEP;
pub use picture::Picture;
pub use scales::Scales;
