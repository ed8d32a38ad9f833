//! What is studied: figures of arms, linkages and mechanisms, without any picture.

pub mod accuracy;
pub mod clearance;
pub mod linkage;
pub mod mobility;
pub mod query;
pub mod workspace;
