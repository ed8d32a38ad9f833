//! Who does by hand what a step asks for: a person, or the simulated operator.

use super::StepError;
use super::question::{Answer, Question};
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
    /// Turn the joints to about these angles [rad].
    Place([f64; 2]),
    /// Mark on the paper where the tip is, with this number.
    Mark(usize),
    /// Set the current of both drivers.
    SetCurrent,
    /// Set both drives on a bus.
    SetDrives,
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
            Self::Place([theta1, theta4]) => format!(
                "Turn the arm by hand until the crank of joint 1 points to about {:.0}° and that of joint 4 to about {:.0}°, \
                 both counted counter-clockwise from the line from joint 1 to joint 4",
                theta1.to_degrees(),
                theta4.to_degrees()
            ),
            Self::Mark(number) => format!(
                "Mark on the paper the place where the tip is, and write {} beside it",
                number + 1
            ),
            Self::SetCurrent => {
                "Set both drivers to this current, and measure what you have set".into()
            }
            Self::SetDrives => {
                "Set both drives to these values by their maker's program, and store them".into()
            }
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

    /// Asks a person a question and returns the index of the answer.
    ///
    /// # Errors
    /// Nobody is there any more, or a stop.
    fn choose(&mut self, question: &str, answers: &[String]) -> Result<usize, StepError>;
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

    /// A motion begins of which will be asked: the simulated operator looks.
    pub(super) fn look(&self) {
        if let Some(actions) = &self.actions {
            actions.look();
        }
    }

    /// What a person has seen, or the simulated operator.
    pub(super) fn see(&mut self, question: &Question) -> Result<Answer, StepError> {
        let text = format!("{}?", question.text());
        if let Some(actions) = &self.actions {
            self.output.ask(&text, true)?;
            return Ok(actions.seen(question));
        }
        let answers = question.answers();
        let words: Vec<String> = answers.iter().map(|(_, words)| words.clone()).collect();
        let chosen = self.output.choose(&text, &words)?;
        let answer = answers.get(chosen).map(|(answer, _)| *answer);
        answer.ok_or_else(|| StepError::other("there is no such answer"))
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

#[cfg(test)]
mod tests {
    use super::{Operator, Output, StepError};
    use crate::commission::question::{Answer, Question};
    use fivebar_kinematics::five_bar::Joint;

    /// A person who always gives the answer with these words.
    struct Person(&'static str);

    impl Output for Person {
        fn report(&mut self, _: &str) -> Result<(), StepError> {
            Ok(())
        }

        fn ask(&mut self, _: &str, _: bool) -> Result<(), StepError> {
            Ok(())
        }

        fn choose(&mut self, question: &str, answers: &[String]) -> Result<usize, StepError> {
            assert!(question.ends_with('?'), "{question}");
            let found = answers.iter().position(|answer| answer == self.0);
            found.ok_or_else(|| StepError::other(answers.join(", ")))
        }
    }

    #[test]
    fn a_person_sees_what_the_chosen_words_say() {
        for (words, question, wanted) in [
            ("it is held", Question::IsHeld(Joint::Joint1), Answer::Held),
            (
                "joint 1 turned",
                Question::Way(Joint::Joint4, 0.1),
                Answer::OtherJoint,
            ),
            (
                "it turned clockwise",
                Question::Way(Joint::Joint4, -0.1),
                Answer::AsAsked,
            ),
            (
                "by about 10°",
                Question::Far(Joint::Joint1, 20_f64.to_radians()),
                Answer::Share(0.5),
            ),
            ("yes", Question::Moves(Joint::Joint1), Answer::Moved),
        ] {
            let mut operator = Operator::new(Box::new(Person(words)), None);
            assert_eq!(operator.see(&question).unwrap(), wanted, "{words}");
        }
    }
}
