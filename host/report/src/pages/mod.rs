//! The HTML pages of runs and studies.

pub mod accuracy;
mod board_test;
mod clearance;
mod crossing;
mod linkage;
mod margins;
mod mobility;
mod plan;
mod run;
mod synthesis;

pub use board_test::board_test;
pub use clearance::clearance;
pub use crossing::crossing;
pub use linkage::linkage;
pub use margins::margins;
pub use mobility::mobility;
pub use plan::plan;
pub use run::RunReport;
pub use synthesis::synthesis_files;
