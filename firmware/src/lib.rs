#![doc = include_str!("../README.md")]
#![no_std]

pub mod board;
pub mod controller;
pub mod drivers;
pub mod drives;
pub mod io;
pub mod motion;
pub mod planner;
pub mod protocol;
pub mod recorder;
pub mod safety;
pub mod session;
pub mod settings;
pub mod storage;

pub use controller::{ArmController, Controller, Request, Status};
pub use io::{ActuatorCommand, ArmCommand, ArmSample, SensorSample, ToldSample};
pub use motion::{ARC_TOLERANCE, CrossingMove, FULL_TOOL, Move, MoveKind, TimedCurve, TimedMove};
pub use planner::Planner;
pub use settings::Settings;
