//! What is read: files that say what is built and what it is to do, checked once.

pub mod accuracy_classes;
pub mod job;
pub mod linkage;
pub mod mobility;
pub mod robot;
pub mod scenario;
pub mod source;
