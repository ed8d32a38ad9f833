//! Accuracy of a robot: what its tolerances and clearances do to position and force, by
//! analysis and by sampling, side by side.

mod along;
mod answer;
mod classes;
mod map;
mod monte_carlo;
mod report;
mod sampling;
mod state;

pub use along::{Along, Flip, Station, along};
pub use answer::{along_answer, answer, map_answer};
pub use classes::Classes;
pub use map::{Cell, Map, cheapest, map};
pub use monte_carlo::{MonteCarlo, draws, monte_carlo, sample_forces, sample_positions};
pub use report::{along_page, at_page, map_page};
pub use sampling::{Moments, Sampling, sample};
pub use state::{Analysis, State, analyse};
