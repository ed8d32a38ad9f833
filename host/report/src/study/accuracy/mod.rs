//! The accuracy of a robot or a linkage: the effect of its tolerances and clearances on
//! positions and forces. The analysis and the sampling are in
//! [`fivebar_design::accuracy`]; here they are applied to files and jobs, and shown as JSON.

mod answer;
mod error;
mod five_bar;
mod linkage;
mod path;
mod slider;

pub(crate) use answer::JOINTS;
pub use answer::{allocation_answer, answer, map_answer, path_answer};
pub use error::AccuracyStudyError;
pub use five_bar::{Cheapest, accuracy_map, analyse, cheapest, without_tolerance};
pub(crate) use linkage::drive_name;
pub use linkage::{linkage_answer, study_linkage};
pub use path::{ContactLoss, PathAccuracy, PathPoint, path_accuracy};
pub use slider::{analyse_slider, slider_answer};
