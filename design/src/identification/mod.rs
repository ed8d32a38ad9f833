//! Dynamic identification: the base parameters and the friction of an arm from a log of its
//! motion.
//!
//! The torques of an arm are linear in its masses: τ = Y φ, with the first moments h = m c and the
//! moments of inertia J about the proximal joints. Only combinations of them are seen, the base
//! parameters β: 7 on a level arm, 11 with gravity in the plane. Their columns are those of J1,
//! J4, J2, J3, h2x, h2y, h3y and, with gravity, h1x, h1y, h4x, h4y in Y as they stand:
//! τ = Y_b β ([`Regressor`], [`base_parameters`]). Viscous and Coulomb friction and an offset of
//! each joint join them ([`identify`]).

mod arm_masses;
mod belt;
mod check;
mod encoders;
mod error;
mod estimate;
mod excitation;
mod filter;
mod followed;
mod least_squares;
mod log;
mod payload;
mod physical;
mod processing;
mod proposal;
mod regressor;
mod spikes;
mod validation;

pub use arm_masses::{base_parameters, standard_parameters};
pub use belt::{BeltArm, BeltLog, FoundBelt, identify_belt};
pub use encoders::{ENCODER_HARMONICS, EncoderErrors, FoundErrors, identify_encoders};
pub use error::IdentificationError;
pub use estimate::{Identification, identify};
pub use excitation::{Excitation, HARMONICS};
pub use log::{Log, Observed};
pub use payload::{Payload, identify_payload};
pub use physical::{PhysicalLinks, physical_links};
pub use proposal::{Bounds, ProposedExcitation, propose_excitation};
pub use regressor::{BASE_COLUMNS, BASE_NAMES, Regressor};
pub use validation::{Misprediction, Predictor, validate};
