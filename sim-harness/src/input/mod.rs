//! Input files: robots, jobs, scenarios, linkages and mechanisms, read and checked once.

pub mod accuracy_classes;
pub mod job;
pub mod linkage;
pub mod mobility;
pub mod path_case;
pub mod robot;
pub mod scenario;
pub mod source;
mod text_file;
