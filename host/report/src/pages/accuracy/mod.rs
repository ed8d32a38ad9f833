//! Pages of accuracy: figures by analysis and sampling, and contributions.

mod five_bar;
mod heat_map;
mod linkage;
mod pareto;
mod slider;

pub use five_bar::{at_page, map_page, path_page};
pub use linkage::linkage_page;
pub use slider::slider_page;
