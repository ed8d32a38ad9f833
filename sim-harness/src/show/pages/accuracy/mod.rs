//! Accuracy on a page: figures beside their samples, and who contributes.

mod five_bar;
mod linkage;
mod pareto;
mod slider;

pub use five_bar::{along_page, at_page, map_page};
pub use linkage::linkage_page;
pub use slider::slider_page;
