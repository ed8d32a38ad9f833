//! Simulate, check and drive a planar five-bar arm: the library behind `fivebar`.

pub mod accuracy;
pub mod clearance;
#[cfg(feature = "program")]
pub mod cli;
pub mod contact;
#[cfg(feature = "program")]
pub mod doctor;
pub mod drive;
pub mod export;
pub mod job;
pub mod link;
pub mod linkage;
pub mod mobility;
pub mod plant;
pub mod query;
pub mod report;
pub mod robot;
pub mod run;
#[cfg(feature = "program")]
pub mod serve;
#[cfg(feature = "program")]
pub mod workspace;
