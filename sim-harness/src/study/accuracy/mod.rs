//! Accuracy of a robot or a linkage: what its tolerances and clearances do to position and force, by
//! analysis and by sampling, side by side.

mod along;
mod answer;
mod linkage;
mod map;
mod monte_carlo;
mod sampling;
mod slider;
mod state;

pub use along::{Along, Flip, Station, along};
pub(crate) use answer::JOINTS;
pub use answer::{along_answer, answer, map_answer};
pub(crate) use linkage::drive_name;
pub use linkage::{
    LinkageAnalysis, LinkageStudy, Reach, analyse_linkage, linkage_answer, sample_linkage,
    study_linkage,
};
pub use map::{Cell, Map, cheapest, map};
pub use monte_carlo::{MonteCarlo, draws, monte_carlo, sample_forces, sample_positions};
pub use sampling::{Moments, Sampling, Spread, Sums, sample};
pub use slider::{SliderAnalysis, SliderMonteCarlo, analyse_slider, sample_slider, slider_answer};
pub use state::{Analysis, State, analyse};
