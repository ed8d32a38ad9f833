//! The HTML pages of runs and studies.

pub mod accuracy;
mod clearance;
mod linkage;
mod mobility;
mod run;

pub use clearance::clearance;
pub use linkage::linkage;
pub use mobility::mobility;
pub use run::RunReport;
