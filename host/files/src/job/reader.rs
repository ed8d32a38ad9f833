//! What reads jobs: this process, or one of its own, which a hostile file cannot take anything away from.

use super::{Job, JobError, JobOptions, Placement};
use std::fmt;

/// A function that reads jobs as [`Job::parse_with`] does, which is the default.
#[derive(Clone, Copy)]
pub struct JobReader(pub fn(&str, &Placement, &JobOptions) -> Result<Job, JobError>);

impl Default for JobReader {
    fn default() -> Self {
        Self(Job::parse_with)
    }
}

impl PartialEq for JobReader {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::fn_addr_eq(self.0, other.0)
    }
}

impl fmt::Debug for JobReader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JobReader")
    }
}
