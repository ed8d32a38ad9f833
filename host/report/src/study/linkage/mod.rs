//! The results of a linkage's sweep: limits, branches and forces.

mod parts;
mod summary;

pub(crate) use parts::{branch, moment, sliding_joints};
pub use summary::{
    Assembly, BranchChangeFound, LimitFound, PeakReaction, Range, SHOWN_ASSEMBLIES, Summary,
    explain, summary,
};
