//! Plans at the limits of the arm against figures of independent solvers.

mod crossing;
mod crossing_arm;
mod crossing_controller;
mod crossing_evidence;
mod crossing_loop;
mod crossing_verdict;
mod jobs;
mod mode_changes;
mod regions;
mod time_optimal;
mod working_modes;
