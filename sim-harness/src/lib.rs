#![doc = include_str!("../README.md")]

pub mod input;
pub mod run;
pub mod show;
pub mod study;
