#![doc = include_str!("../README.md")]
#![no_std]

pub mod control;
pub mod dynamics;
pub mod five_bar;
pub mod scalar;
pub mod trajectory;
mod vector;

/// The vectors and matrices of every signature here.
pub use nalgebra;
pub use scalar::Scalar;
pub use vector::PlanarVector;
