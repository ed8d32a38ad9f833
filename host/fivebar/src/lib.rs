#![doc = include_str!("../README.md")]

pub mod bridge;
pub mod cli;
mod commission;
pub mod doctor;
pub mod flash;
mod job_process;
pub mod pen_heights;
#[cfg(feature = "ros")]
pub mod ros;
pub mod senders;
pub mod serve;
#[cfg(test)]
mod test_session;
