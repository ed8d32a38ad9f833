//! Text for users: numbers with units, and sentences.

mod calibration;
mod conditions;
mod ending;
mod identification;
mod margins;
mod mobility;
mod photo;
mod quantity;
mod synthesis;
mod workspace;

pub use calibration::{Calibrated, calibration, proposal};
pub use conditions::conditions;
pub use ending::{fault_and_next_step, next_step, no_demo_scale, not_drawn, refusal, stopped_by};
pub use identification::{identification, payload, validation};
pub use margins::margins;
pub use mobility::explain;
pub(crate) use mobility::steps;
pub use photo::photo;
pub use quantity::quantity;
pub use synthesis::synthesis;
pub(crate) use synthesis::{drive_line, proof_sentence};
pub use workspace::workspace;
