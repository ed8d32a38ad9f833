#![doc = include_str!("../README.md")]

pub mod accuracy;
mod dual;
pub mod linkage;
pub mod mobility;
pub mod slider;
pub mod workspace;

pub use dual::Dual;
