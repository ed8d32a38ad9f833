//! The portable part of the controller: everything but registers.
//!
//! [`Sensed`] in, [`Command`] out, at the tick rate. It compiles for a desktop and for a
//! Cortex-M4F from the same source and gives the same bits on both.
#![no_std]

#[cfg(feature = "board")]
pub mod board;
pub mod controller;
pub mod drivers;
pub mod io;
pub mod motion;
pub mod planner;
pub mod protocol;
pub mod safety;
pub mod session;
pub mod settings;
pub mod storage;

pub use controller::{Controller, Request, Status};
pub use io::{Command, Sensed};
pub use motion::{Move, MoveKind};
pub use planner::Planner;
pub use settings::Settings;
