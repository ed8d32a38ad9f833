//! A linkage through its motion: limits, branches and forces in a few numbers.

mod parts;
mod summary;

pub(crate) use parts::{branch, moment, slides};
pub use summary::{
    Assembly, BranchChangeFound, LimitFound, PeakReaction, Range, SHOWN_ASSEMBLIES, Summary,
};
