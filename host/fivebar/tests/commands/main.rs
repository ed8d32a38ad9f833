//! The commands of the program `fivebar`, run as a user runs them.

mod accuracy;
#[path = "../arms/mod.rs"]
mod arms;
mod bench;
mod by_cause;
mod calibrate;
mod clearance;
mod closed_output;
mod commission;
mod commission_bus;
mod commission_kinds;
mod commission_limits;
mod demonstration;
mod design;
#[cfg(unix)]
mod doctor;
mod doors;
#[cfg(unix)]
mod emulator_lifetime;
mod export;
mod extremes;
mod flash;
mod full_disk;
mod home_index;
mod home_methods;
mod identify;
#[cfg(target_os = "linux")]
mod job_process;
mod linkage;
mod new;
#[cfg(unix)]
mod other_release;
mod pen;
mod photo;
mod placement;
mod plan;
mod query;
mod query_slider;
mod random_arms;
mod repeat;
mod shell_help;
mod sim;
mod sim_motors;
mod text;
mod verdict;
mod workspace;
mod worn_joints_document;
