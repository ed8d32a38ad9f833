//! Who does by hand what a step asks for: a person, or the simulated operator.

use super::StepError;
use super::simulated::OperatorActions;
use fivebar_kinematics::five_bar::Joint;

/// Something to be done by hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Task {
    /// Press the emergency stop.
    PressStop,
    /// Release it.
    ReleaseStop,
    /// Press the home switch of a joint.
    PressSwitch(Joint),
    /// Release both home switches.
    ReleaseSwitches,
    /// Turn a joint by this angle [rad], and hold the other one.
    Turn(Joint, f64),
    /// Put the tip into the hole of this number and place [m].
    Hole(usize, [f64; 2]),
    /// Hold the arm at its home angles.
    Home,
    /// Let go of the arm.
    LetGo,
}

impl Task {
    fn text(&self) -> String {
        match *self {
            Self::PressStop => "Press the emergency stop and keep it pressed".into(),
            Self::ReleaseStop => "Release the emergency stop".into(),
            Self::PressSwitch(joint) => {
                format!("Press the home switch of {joint} and keep it pressed")
            }
            Self::ReleaseSwitches => "Release the home switch".into(),
            Self::Turn(joint, by) => format!(
                "Turn {joint} by hand {} by {:.0}° (use a set square) and hold the other joint",
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

/// Receives progress and results, and asks a person for tasks.
pub(crate) trait Output: Send {
    /// Reports a line.
    ///
    /// # Errors
    /// Nobody is there any more.
    fn report(&mut self, line: &str) -> Result<(), StepError>;

    /// Asks for a task and returns when a person has done it, or when the simulated operator may do it.
    ///
    /// # Errors
    /// Nobody is there any more, or a stop.
    fn ask(&mut self, task: &str, simulated: bool) -> Result<(), StepError>;
}

/// Who does the tasks: a person, or the simulated operator.
pub(super) struct Operator {
    output: Box<dyn Output>,
    actions: Option<OperatorActions>,
}

impl Operator {
    /// An operator who does the tasks at the simulated arm, if there is one.
    pub(super) fn new(output: Box<dyn Output>, actions: Option<OperatorActions>) -> Self {
        Self { output, actions }
    }

    /// The actions at the simulated arm.
    pub(super) fn actions(&self) -> Option<&OperatorActions> {
        self.actions.as_ref()
    }

    /// Reports a line.
    pub(super) fn report(&mut self, line: &str) -> Result<(), StepError> {
        self.output.report(line)
    }

    /// Asks for a task. A person has done it on return; the simulated operator has begun.
    pub(super) fn ask(&mut self, task: &Task) -> Result<(), StepError> {
        self.output.ask(&task.text(), self.actions.is_some())?;
        match &self.actions {
            Some(actions) => actions.begin(task),
            None => Ok(()),
        }
    }

    /// What follows belongs to this step.
    pub(super) fn begin_step(&self, step: &'static str) {
        if let Some(actions) = &self.actions {
            actions.begin_step(step);
        }
    }

    /// What happened to the simulated arm in each step, as JSON; none of a real one.
    pub(super) fn observed(&self) -> Result<Option<String>, StepError> {
        self.actions
            .as_ref()
            .map(OperatorActions::observed)
            .transpose()
    }

    /// Whether the task is done.
    pub(super) fn is_done(&self) -> bool {
        self.actions.as_ref().is_none_or(OperatorActions::is_done)
    }
}
