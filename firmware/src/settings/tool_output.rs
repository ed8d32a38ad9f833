//! The output for a tool: a hobby servo that lifts a pen, a switch, or a power set by PWM.

use super::table::LONGEST_PULSE;
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

    /// Pulses of a servo per second [Hz].
    pub(super) fn frame_rate(&self) -> Option<[f32; 1]> {
        match *self {
            Self::Servo { frame_rate, .. } => Some([frame_rate]),
            _ => None,
        }
    }

    /// The pulse widths of a servo [s].
    pub(super) fn pulse_widths(&self) -> Option<[f32; 2]> {
        match *self {
            Self::Servo {
                up_width,
                down_width,
                ..
            } => Some([up_width, down_width]),
            _ => None,
        }
    }

    /// Whether the pulses of a servo differ, and are not too long for its frames.
    pub(super) fn pulses_fit(&self) -> bool {
        match *self {
            Self::Servo {
                up_width,
                down_width,
                frame_rate,
                ..
            } => {
                let fits = |width| width * frame_rate <= LONGEST_PULSE;
                fits(up_width) && fits(down_width) && up_width != down_width
            }
            _ => true,
        }
    }

    /// The times for which the arm waits [s].
    pub(super) fn settle_times(&self) -> Option<[f32; 2]> {
        match *self {
            Self::Servo {
                down_time, up_time, ..
            }
            | Self::Switch {
                down_time, up_time, ..
            } => Some([down_time, up_time]),
            Self::None | Self::Power { .. } => None,
        }
    }

    /// Frequency of a power's PWM [Hz].
    pub(super) fn frequency(&self) -> Option<[f32; 1]> {
        match *self {
            Self::Power { frequency, .. } => Some([frequency]),
            _ => None,
        }
    }
}
