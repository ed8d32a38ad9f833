//! A pin (journal) in a bearing with clearance: contact, impact, flight.
//!
//! | module | content |
//! |---|---|
//! | `material` | material and restitution of pins and bearings, `[contact]` of a robot file |
//! | `law` | contact laws with restitution |
//! | `journal` | the contact force between pin and bearing, and when contact begins and ends |
//! | `dormand_prince` | integration with adaptive steps and event location |
//!
//! Nothing here depends on a particular mechanism.

mod dormand_prince;
mod journal;
mod law;
mod material;

pub use dormand_prince::{DormandPrince45, HybridSystem};
pub use journal::{ClearanceError, ContactForce, Eccentricity, Journal, Phase};
pub use material::{Contact, InvalidValue, Restitution};
