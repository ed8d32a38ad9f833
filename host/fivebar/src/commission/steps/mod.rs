//! The steps.

mod arm;
mod belts;
mod bridge_limit;
mod bus;
mod contactor;
mod dead_band;
mod driver_current;
mod dynamics;
mod electrics;
mod enable;
mod encoder_errors;
mod fit;
mod friction;
mod geometry;
mod index;
mod inputs;
mod marks;
mod motors;
mod moving;
mod order;
mod reserve;
mod standing;
mod strokes;
mod told_torque;
mod turns;

use super::bench::Bench;
use super::finding::StepError;
use super::record::Value;
use fivebar_files::robot::{Measured, MeasuredKey};

pub(crate) use order::{named, names, of};

/// What a step found.
pub(super) struct Outcome {
    /// As a sentence.
    pub(super) found: String,
    /// For the record.
    pub(super) values: Vec<Value>,
    /// For the robot file.
    pub(super) measured: Vec<Measured>,
    /// A picture of it as SVG.
    pub(super) picture: Option<String>,
    /// The arm has nothing that the step could measure.
    pub(super) left_out: bool,
}

impl Outcome {
    fn new(found: impl Into<String>, values: Vec<Value>) -> Self {
        Self {
            found: found.into(),
            values,
            measured: Vec::new(),
            picture: None,
            left_out: false,
        }
    }

    /// Of a step that this arm does not need, or cannot do: why.
    fn left_out(why: impl Into<String>) -> Self {
        Self {
            left_out: true,
            ..Self::new(why, Vec::new())
        }
    }
}

/// A value for the robot file.
fn measured(key: MeasuredKey, value: String, origin: String) -> Measured {
    Measured { key, value, origin }
}

/// A step.
pub(crate) struct Step {
    /// Its name in the record and on the command line.
    pub(crate) name: &'static str,
    /// What it will do.
    pub(crate) does: &'static str,
    /// Does it.
    pub(super) run: fn(&mut Bench) -> Result<Outcome, StepError>,
}
