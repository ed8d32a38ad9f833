//! The output for a tool: a hobby servo that lifts a pen, a switch, or a power set by PWM.

use super::Field;
use super::range::{FRAME_RATE, POWER_FREQUENCY, PULSE_WIDTH, SETTLE_TIME};
use crate::motion::FULL_TOOL;
use fivebar_kinematics::trajectory::ToolOutput;
use serde::{Deserialize, Serialize};

/// The share of time for which the tool's pin is high, in 1/65536; [`ALWAYS`] for all the time.
pub type Share = u16;

/// The pin is high all the time.
pub const ALWAYS: Share = u16::MAX;

/// Shares in a whole.
const WHOLE: f32 = 65_536.0;

/// What is added to a share, so that cutting rounds it.
const ROUNDING: f32 = 0.5;

/// Greatest part of a frame that a servo's pulse may take.
const LONGEST_PULSE: f32 = 0.9;

/// The kind of the tool's output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum ToolOutputSettings {
    /// No output. The level of each move is followed and reported all the same.
    #[default]
    None,
    /// A hobby servo: one pulse per frame, whose width is the servo's position.
    Servo {
        /// Width with the tool up [s].
        up_width: f32,
        /// Width with the tool down [s].
        down_width: f32,
        /// Pulses per second [Hz].
        frame_rate: f32,
        /// Time that the tool takes to come down [s]; the arm waits for it.
        down_time: f32,
        /// Time that the tool takes to lift [s]; the arm waits for it.
        up_time: f32,
    },
    /// On or off.
    Switch {
        /// The pin is low to switch on.
        active_low: bool,
        /// Time to switch on [s]; the arm waits for it.
        down_time: f32,
        /// Time to switch off [s]; the arm waits for it.
        up_time: f32,
    },
    /// A power by PWM: the arm does not stop where it changes.
    Power {
        /// Of the PWM [Hz].
        frequency: f32,
        /// The share follows the speed: all of it at the requested speed, none at rest.
        scale_with_speed: bool,
    },
}

impl ToolOutputSettings {
    /// Whether the arm rests and waits where the output changes, and keeps the output where a
    /// path ends. Without it, the output is off where no path is followed.
    pub fn waits(&self) -> bool {
        match self {
            Self::Servo { .. } | Self::Switch { .. } => true,
            Self::None | Self::Power { .. } => false,
        }
    }

    /// Time for which the arm waits after a change from level `from` to `to` [s].
    pub fn settle_time(&self, from: u16, to: u16) -> f32 {
        match *self {
            Self::Servo {
                down_time, up_time, ..
            }
            | Self::Switch {
                down_time, up_time, ..
            } => {
                if to > from {
                    down_time
                } else {
                    up_time
                }
            }
            Self::None | Self::Power { .. } => 0.0,
        }
    }

    /// The output with the tool up or off: in every state that follows no path, and from the tick
    /// on in which a stop begins or a fault is found.
    pub fn off(&self) -> Share {
        self.output(0, 1.0).at_rest as Share
    }

    /// The output at a level, along a move with this requested speed [m/s or rad/s]. Cut to a whole
    /// number it is the nearest share.
    pub fn output(&self, level: u16, speed: f32) -> ToolOutput<f32> {
        let share = f32::from(level) / f32::from(FULL_TOOL);
        let at_rest = match *self {
            Self::None
            | Self::Power {
                scale_with_speed: false,
                ..
            } => f32::from(level),
            Self::Power {
                scale_with_speed: true,
                ..
            } => {
                return ToolOutput {
                    at_rest: ROUNDING,
                    per_speed: f32::from(level) / speed,
                };
            }
            Self::Servo {
                up_width,
                down_width,
                frame_rate,
                ..
            } => WHOLE * frame_rate * (up_width + share * (down_width - up_width)),
            Self::Switch { active_low, .. } => {
                if (level > 0) == active_low {
                    0.0
                } else {
                    f32::from(ALWAYS)
                }
            }
        };
        ToolOutput::constant(at_rest + ROUNDING)
    }

    /// The level that an output stands for, as a share: 0 is up or off, 1 is down or full power.
    pub fn level(&self, output: Share) -> f32 {
        let [up, down] = [0, FULL_TOOL].map(|level| self.output(level, 1.0));
        let [up, down] = [up.at(1.0), down.at(1.0)];
        if output == self.off() {
            return 0.0;
        }
        ((f32::from(output) + ROUNDING - up) / (down - up)).clamp(0.0, 1.0)
    }

    /// The first field that is invalid.
    pub(super) fn broken_field(&self) -> Option<Field> {
        let within = |[least, greatest]: [f32; 2], value| least <= value && value <= greatest;
        let settles = |down, up| within(SETTLE_TIME, down) && within(SETTLE_TIME, up);
        match *self {
            Self::None => None,
            Self::Servo {
                up_width,
                down_width,
                frame_rate,
                down_time,
                up_time,
            } => {
                let fits =
                    |width| within(PULSE_WIDTH, width) && width * frame_rate <= LONGEST_PULSE;
                if !within(FRAME_RATE, frame_rate) {
                    Some(Field::ToolFrameRate)
                } else if !(fits(up_width) && fits(down_width) && up_width != down_width) {
                    Some(Field::ToolPulseWidth)
                } else {
                    (!settles(down_time, up_time)).then_some(Field::ToolSettleTime)
                }
            }
            Self::Switch {
                down_time, up_time, ..
            } => (!settles(down_time, up_time)).then_some(Field::ToolSettleTime),
            Self::Power { frequency, .. } => {
                (!within(POWER_FREQUENCY, frequency)).then_some(Field::ToolFrequency)
            }
        }
    }
}
