//! A journal in a bearing with clearance: contact, impact, flight.
//!
//! | module | what it holds |
//! |---|---|
//! | `law` | the laws of restitution |
//! | `journal` | the force between pin and bearing, and when they meet and part |
//! | `dormand_prince` | integration with a step that suits the contact, from event to event |
//!
//! None of this knows of any mechanism.

mod dormand_prince;
mod journal;
mod law;

pub use dormand_prince::{DormandPrince45, HybridSystem};
pub use journal::{Eccentricity, Journal, NoJournal, Phase, Touch};
