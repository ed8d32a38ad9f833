#![doc = include_str!("../README.md")]

pub mod accuracy;
pub mod calibration;
pub mod crossing;
pub mod derivatives;
mod dual;
mod fit;
mod gradient;
pub mod guide;
pub mod identification;
pub mod joint_path;
pub mod linkage;
pub mod mobility;
mod noise;
pub mod photo;
mod robust;
pub mod servo;
pub mod slider;
mod statistics;
pub mod synthesis;
pub mod time_optimal;
pub mod workspace;

pub use dual::{Dual, HyperDual};
pub use gradient::Gradient;
pub use noise::Noise;
