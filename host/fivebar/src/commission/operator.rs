//! Who does by hand what a step asks for: a person, or the simulated arm's hand.

use super::StepError;
use super::simulated::Hand;

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

/// Receives progress and results, and does the tasks that a person has to do.
pub(crate) trait Voice: Send {
    /// Tells a line.
    ///
    /// # Errors
    /// Nobody is there any more.
    fn tell(&mut self, line: &str) -> Result<(), StepError>;

    /// Asks for a task and returns when a person has done it, or when the simulated arm's hand may do it.
    ///
    /// # Errors
    /// Nobody is there any more, or a stop.
    fn ask(&mut self, task: &str, simulated: bool) -> Result<(), StepError>;
}

/// Who does the tasks: a person, or the simulated arm's hand.
pub(super) struct Operator {
    voice: Box<dyn Voice>,
    hand: Option<Hand>,
}

impl Operator {
    /// An operator who does tasks with the simulated arm's hand, if there is one.
    pub(super) fn new(voice: Box<dyn Voice>, hand: Option<Hand>) -> Self {
        Self { voice, hand }
    }

    /// The simulated arm's hand.
    pub(super) fn hand(&self) -> Option<&Hand> {
        self.hand.as_ref()
    }

    /// Tells a line.
    pub(super) fn tell(&mut self, line: &str) -> Result<(), StepError> {
        self.voice.tell(line)
    }

    /// Asks for a task. A person has done it on return; the simulated hand has begun.
    pub(super) fn ask(&mut self, task: &Task) -> Result<(), StepError> {
        self.voice.ask(&task.text(), self.hand.is_some())?;
        match &self.hand {
            Some(hand) => hand.begin(task),
            None => Ok(()),
        }
    }

    /// What follows belongs to this step.
    pub(super) fn begin_step(&self, step: &'static str) {
        if let Some(hand) = &self.hand {
            hand.begin_step(step);
        }
    }

    /// What the simulated arm went through in each step, as JSON; none of a real one.
    pub(super) fn witnessed(&self) -> Result<Option<String>, StepError> {
        self.hand.as_ref().map(Hand::witnessed).transpose()
    }

    /// Whether the task is done.
    pub(super) fn is_done(&self) -> bool {
        self.hand.as_ref().is_none_or(Hand::is_done)
    }
}
