//! The steps, in their order.

mod arm;
mod belts;
mod bridge_limit;
mod contactor;
mod dynamics;
mod electrics;
mod encoder_errors;
mod fit;
mod friction;
mod geometry;
mod index;
mod inputs;
mod motors;
mod moving;

use super::bench::Bench;
use super::finding::StepError;
use super::record::Value;
use fivebar_files::robot::{Measured, MeasuredKey};

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
}

impl Outcome {
    fn new(found: impl Into<String>, values: Vec<Value>) -> Self {
        Self {
            found: found.into(),
            values,
            measured: Vec::new(),
            picture: None,
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

/// All steps.
pub(crate) const STEPS: [Step; 13] = [
    Step {
        name: "supply",
        does: "reads the bus voltage and the current sensors; nothing is switched on",
        run: inputs::supply,
    },
    Step {
        name: "emergency-stop",
        does: "asks for the emergency stop, and waits until the bus falls; nothing is switched on",
        run: inputs::emergency_stop,
    },
    Step {
        name: "switches",
        does: "asks for each home switch; nothing is switched on",
        run: inputs::switches,
    },
    Step {
        name: "encoders",
        does: "asks for a turn of each joint by hand; nothing is switched on",
        run: inputs::encoders,
    },
    Step {
        name: "motors",
        does: "puts a small voltage on one motor at a time, for 0.15 s and 0.1 rad at most, up to \
               the motor's continuous current",
        run: motors::directions,
    },
    Step {
        name: "electrics",
        does: "puts voltages on one motor at a time, for 0.8 s and 0.45 rad at most, up to the \
               motor's continuous current, and the whole voltage for 2 ms, up to the bridge's own current \
               limit; the joints must be free to turn away from their switches",
        run: electrics::electrics,
    },
    Step {
        name: "homing",
        does: "homes the arm three times by the method of [homing], at its speed and current",
        run: arm::homing,
    },
    Step {
        name: "belts",
        does: "homes the arm, then puts a pseudo-random voltage on one motor at a time, for 0.3 s and 0.45 rad at \
               most; an arm without belts is left as it is",
        run: belts::belts,
    },
    Step {
        name: "friction",
        does: "homes the arm, then turns one joint at a time there and back at constant speeds",
        run: friction::friction,
    },
    Step {
        name: "geometry",
        does: "homes the arm, then asks for the tip in holes of a plate; the bridges are off",
        run: geometry::geometry,
    },
    Step {
        name: "dynamics",
        does: "homes the arm, then moves both joints fast through the workspace, twice for some seconds",
        run: dynamics::dynamics,
    },
    Step {
        name: "tuning",
        does: "works out the gains from what was measured; nothing moves",
        run: arm::tuning,
    },
    Step {
        name: "validation",
        does: "draws the demonstration in the air with the values of the drawing, then with the \
               measured ones",
        run: arm::validation,
    },
];
