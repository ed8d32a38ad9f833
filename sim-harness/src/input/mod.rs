//! Input files: robots, jobs, scenarios, linkages, mechanisms and measurements, read and checked
//! once.

pub mod accuracy_classes;
pub mod job;
pub mod linkage;
pub mod measurements;
pub mod mobility;
pub mod path_case;
pub mod robot;
pub mod scenario;
mod similar;
pub mod source;
pub(crate) mod text_file;

pub(crate) use similar::did_you_mean;
