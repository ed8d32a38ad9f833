//! Studies of arms, linkages and mechanisms, as figures and JSON.

pub mod accuracy;
pub mod calibration;
pub mod clearance;
pub mod crossing;
pub mod identification;
pub mod linkage;
pub mod margins;
pub mod mobility;
pub mod photo;
pub mod plan;
pub mod query;
pub mod regions;
pub mod synthesis;
pub mod workspace;
