//! The accuracy of a robot or a linkage: the effect of its tolerances and clearances on
//! positions and forces, by analysis and by sampling.

mod analysis;
mod answer;
mod error;
mod linkage;
mod map;
mod monte_carlo;
mod path;
mod sampling;
mod slider;

pub use analysis::{AccuracyAnalysis, ToolState, analyse};
pub(crate) use answer::JOINTS;
pub use answer::{answer, map_answer, path_answer};
pub use error::{AccuracyStudyError, PlaceError};
pub(crate) use linkage::drive_name;
pub use linkage::{
    LinkageAnalysis, LinkageStudy, PointError, analyse_linkage, linkage_answer, sample_linkage,
    study_linkage,
};
pub use map::{AccuracyCell, AccuracyMap, accuracy_map, cheapest_classes};
pub use monte_carlo::{MonteCarlo, draws, monte_carlo, sample_forces, sample_positions};
pub use path::{ContactLoss, PathAccuracy, PathPoint, path_accuracy};
pub use sampling::{Accumulator, Deviations, Moments, Sampling, sample};
pub use slider::{SliderAnalysis, SliderMonteCarlo, analyse_slider, sample_slider, slider_answer};
