//! Who does by hand what a step asks for: a person at the terminal, or the simulated arm's hand.

use super::StepError;
use super::simulated::Hand;
use crate::show::cli::say::say;
use std::io::{BufRead, stdin};

/// Something to be done by hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Task {
    /// Press the emergency stop.
    PressStop,
    /// Release it.
    ReleaseStop,
    /// Press a home switch, 0 or 1.
    PressSwitch(usize),
    /// Release both home switches.
    ReleaseSwitches,
    /// Turn a joint, 0 or 1, by this angle [rad], and hold the other one.
    Turn(usize, f64),
    /// Put the tip into the hole of this number and place [m].
    Hole(usize, [f64; 2]),
    /// Hold the arm at its home angles.
    Home,
    /// Let go of the arm.
    LetGo,
}

/// The joint's number.
pub(super) fn number(joint: usize) -> u8 {
    if joint == 0 { 1 } else { 4 }
}

impl Task {
    fn text(&self) -> String {
        match *self {
            Self::PressStop => "Press the emergency stop and keep it pressed".into(),
            Self::ReleaseStop => "Release the emergency stop".into(),
            Self::PressSwitch(joint) => {
                format!(
                    "Press the home switch of joint {} and keep it pressed",
                    number(joint)
                )
            }
            Self::ReleaseSwitches => "Release the home switch".into(),
            Self::Turn(joint, by) => format!(
                "Turn joint {} by hand {} by {:.0}° (use a set square) and hold the other joint",
                number(joint),
                if by > 0.0 {
                    "counter-clockwise"
                } else {
                    "clockwise"
                },
                by.abs().to_degrees()
            ),
            Self::Hole(number, [x, y]) => format!(
                "Put the tip into hole {} at ({:.2}, {:.2}) mm and hold it there",
                number + 1,
                1e3 * x,
                1e3 * y
            ),
            Self::Home => "Put the arm at its home angles with its jig and hold it there".into(),
            Self::LetGo => "Let go of the arm and keep clear of it".into(),
        }
    }
}

/// Who does the tasks.
pub(super) enum Operator {
    /// A person, who presses Enter when a task is done.
    Person,
    /// The hand of the simulated arm.
    Simulated(Hand),
}

impl Operator {
    /// Asks for a task. A person has done it on return; the simulated hand has begun.
    pub(super) fn ask(&mut self, task: &Task) -> Result<(), StepError> {
        match self {
            Self::Simulated(hand) => hand.begin(task),
            Self::Person => {
                say(format_args!("  → {}, then press Enter.", task.text()))
                    .map_err(|_| StepError::other("the output is closed"))?;
                let mut line = String::new();
                match stdin().lock().read_line(&mut line) {
                    Ok(1..) => Ok(()),
                    _ => Err(StepError::other(
                        "the input ended while a step waited for Enter; run the same command \
                         again to go on",
                    )),
                }
            }
        }
    }

    /// What follows belongs to this step.
    pub(super) fn begin_step(&self, step: &'static str) {
        if let Self::Simulated(hand) = self {
            hand.begin_step(step);
        }
    }

    /// What the simulated arm went through in each step, as JSON; none of a real one.
    pub(super) fn witnessed(&self) -> Result<Option<String>, StepError> {
        match self {
            Self::Person => Ok(None),
            Self::Simulated(hand) => hand.witnessed().map(Some),
        }
    }

    /// Whether the task is done.
    pub(super) fn is_done(&self) -> bool {
        match self {
            Self::Person => true,
            Self::Simulated(hand) => hand.is_done(),
        }
    }
}
