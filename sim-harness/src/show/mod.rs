//! The outputs: pages, files for other programs, the live page and the command line.

#[cfg(feature = "program")]
pub mod bridge;
#[cfg(feature = "program")]
pub mod cli;
#[cfg(feature = "program")]
mod commission;
#[cfg(feature = "program")]
pub mod doctor;
pub mod export;
pub mod files;
pub mod pages;
#[cfg(feature = "program")]
mod path_queue;
#[cfg(feature = "program")]
pub mod picture;
pub mod report;
#[cfg(feature = "program")]
pub mod serve;
pub mod text;
