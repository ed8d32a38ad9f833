//! One page for each thing that is run or studied.

pub mod accuracy;
mod clearance;
mod linkage;
mod mobility;
mod run;

pub use clearance::clearance;
pub use linkage::linkage;
pub use mobility::mobility;
pub use run::RunReport;
