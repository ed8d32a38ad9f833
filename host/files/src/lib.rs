#![doc = include_str!("../README.md")]

pub mod accuracy_classes;
mod budget;
pub mod design_spec;
pub mod job;
pub mod lettering;
pub mod linkage;
pub mod measurements;
pub mod mobility;
pub mod path_case;
pub mod picture;
pub mod refusal;
pub mod robot;
pub mod scenario;
mod similar;
pub mod source;
pub mod text_file;

pub use budget::OverBudget;
pub use similar::did_you_mean;
