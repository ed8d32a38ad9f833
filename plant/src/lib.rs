#![doc = include_str!("../README.md")]

mod active_faults;
mod brake;
mod chain;
pub mod contact;
mod dynamics;
mod encoder;
mod fault;
mod mismatch;
mod mismatch_error;
mod motor;
mod parameters;
mod planar;
mod plant;
mod sensors;
mod transmission;
mod worn_joints;

pub use chain::{Chain, JOINTS, PerJoint};
pub use dynamics::{Loads, Model, State};
pub use encoder::{Encoder, EncoderSide, Harmonic, Harmonics, MOST_HARMONICS, TooManyHarmonics};
pub use fault::{FaultKind, PlantFault};
pub use mismatch::{Mismatch, check_harmonics};
pub use mismatch_error::{Bound, MismatchError};
pub use motor::Motor;
pub use parameters::Parameters;
pub use planar::{Body, PlanarVector};
pub use plant::Plant;
pub use sensors::JointSensors;
pub use transmission::Transmission;
pub use worn_joints::{ContactStatistics, WornJoints};
