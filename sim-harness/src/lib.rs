#![doc = include_str!("../README.md")]

pub mod board_test;
#[cfg(not(target_family = "wasm"))]
pub mod controller;
pub mod crossing;
pub mod drive;
pub mod excitation;
pub mod held;
pub mod learning;
pub mod link;
pub mod measured_pose;
pub mod path_queue;
pub mod planned_time;
pub mod segment;
pub mod simulation;
pub mod time_optimal;
