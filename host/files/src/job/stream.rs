//! G-code that arrives line by line, with the modes kept between lines.

use super::evidence::UNDECIDED;
use super::interpreter::Interpreter;
use super::modes::MotionMode;
use super::tool::{Activity, Spindle};
use super::words::Line;
use super::{GcodeError, Job, JobOptions, Placement, Warning, WarningKind};
use crate::budget::Budget;

/// Interprets the lines of a sender one by one.
///
/// A file is read twice, so that all of it shows which words move the tool. A stream cannot be:
/// each line is read by the rules that follow from the lines up to it. The steps, stops and notes
/// of a line have the line number 0.
#[derive(Clone)]
pub struct JobStream {
    interpreter: Interpreter,
    options: JobOptions,
}

impl JobStream {
    /// A stream whose tool is at X0 Y0 of this placement.
    pub fn new(placement: &Placement, options: JobOptions) -> Self {
        // The bridge reports the arm's place, so G28 does not change what it means.
        let interpreter = Interpreter {
            homes_to_zero: false,
            ..Interpreter::new(placement, UNDECIDED)
        };
        Self {
            interpreter,
            options,
        }
    }

    /// Interprets the next line. A line that is refused changes nothing.
    ///
    /// # Errors
    /// What is wrong in the line.
    pub fn line(&mut self, text: &str) -> Result<Job, GcodeError> {
        let line = Line::read(text)?;
        let mut first = self.interpreter.clone();
        first.rules = UNDECIDED;
        first.budget = Budget::points();
        first.line(0, &line)?;
        let mut next = self.interpreter.clone();
        let (rules, notes) = first.evidence.rules(&self.options);
        let is_new = rules.speed != next.rules.speed;
        next.rules = rules;
        next.budget = Budget::points();
        next.line(0, &line)?;
        next.evidence = first.evidence;
        let mut job = std::mem::take(&mut next.job);
        let of_pen = |note: &Warning| matches!(note.kind, WarningKind::PenSpeeds { .. });
        let notes = notes.into_iter().filter(|note| is_new && of_pen(note));
        job.warnings
            .extend(notes.map(|note| Warning { line: 0, ..note }));
        self.interpreter = next;
        Ok(job)
    }

    /// The end of the last motion in the frame of the base [m]; none before the first.
    pub fn position(&self) -> Option<[f64; 2]> {
        self.interpreter.placed
    }

    /// Sets the position of the tool in the frame of the base [m], where it was moved by other
    /// means than lines.
    pub fn set_position(&mut self, tool: [f64; 2]) {
        self.interpreter.position = self.interpreter.placement.unplace(tool);
        self.interpreter.placed = Some(tool);
    }

    /// The position of X0 Y0 in the frame of the base [m]. G92 moves it.
    pub fn zero(&self) -> [f64; 2] {
        self.interpreter.placement.place(self.interpreter.zero)
    }

    /// Metres per unit of the coordinates.
    pub fn unit(&self) -> f64 {
        self.interpreter.modes.unit
    }

    /// The tool's level while the arm rests after the lines so far, 0…1.
    pub fn level(&self) -> f64 {
        let Interpreter {
            modes, tool, rules, ..
        } = &self.interpreter;
        let activity = match modes.motion {
            None | Some(MotionMode::Rapid) => Activity::RestAfterRapid,
            Some(_) => Activity::RestAfterFeed,
        };
        tool.level(rules, activity)
    }

    /// The present modes as words, in the order of Grbl's parser state.
    pub fn modes(&self) -> String {
        let Interpreter {
            modes, tool, feed, ..
        } = &self.interpreter;
        let motion = match modes.motion {
            None | Some(MotionMode::Rapid) => "G0",
            Some(MotionMode::Line) => "G1",
            Some(MotionMode::Clockwise) => "G2",
            Some(MotionMode::CounterClockwise) => "G3",
        };
        let unit = if modes.unit > 1e-3 { "G20" } else { "G21" };
        let distance = if modes.relative { "G91" } else { "G90" };
        let spindle = match tool.spindle {
            Spindle::Constant => "M3",
            Spindle::Dynamic => "M4",
            Spindle::Off => "M5",
        };
        let feed = feed.unwrap_or(0.0) / modes.unit * 60.0;
        let speed = tool.speed.unwrap_or(0.0);
        format!("{motion} G54 G17 {unit} {distance} G94 {spindle} M9 T0 F{feed:.0} S{speed:.0}")
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Action, JobOptions, Placement};
    use super::JobStream;

    fn stream() -> JobStream {
        let origin = [0.04, 0.18];
        let placement = Placement {
            origin,
            scale: 1.0,
            turn: 0.0,
            home: origin,
        };
        JobStream::new(&placement, JobOptions::default())
    }

    #[test]
    fn modes_are_kept_from_line_to_line() {
        let mut stream = stream();
        stream.set_position([0.04, 0.18]);
        assert!(stream.line("G91 G20").unwrap().steps.is_empty());
        assert!(stream.line("G1 F60").unwrap().steps.is_empty());
        let job = stream.line("X1").unwrap();
        let Action::Line { to, feed } = job.steps[0].action else {
            panic!("{job:?}");
        };
        assert!((to[0] - 0.0654).abs() < 1e-12, "{to:?}");
        assert!((feed.unwrap() - 0.0254).abs() < 1e-12);
        assert_eq!(stream.modes(), "G1 G54 G17 G20 G91 G94 M5 M9 T0 F60 S0");
    }

    #[test]
    fn a_refused_line_changes_nothing() {
        let mut stream = stream();
        stream.set_position([0.04, 0.18]);
        let before = stream.modes();
        assert!(stream.line("G91 G1 X5 F100 Q3").is_err());
        assert_eq!(stream.modes(), before);
        assert_eq!(stream.position(), Some([0.04, 0.18]));
    }

    #[test]
    fn the_tool_follows_its_words_from_the_line_that_shows_them() {
        let mut stream = stream();
        stream.set_position([0.04, 0.18]);
        assert!(stream.line("G1 X1 F600").unwrap().steps[0].draws());
        stream.line("M3 S1000").unwrap();
        assert!(stream.line("X2").unwrap().steps[0].draws());
        stream.line("M5").unwrap();
        assert!(!stream.line("X3").unwrap().steps[0].draws());
    }

    #[test]
    fn g92_moves_the_zero() {
        let mut stream = stream();
        stream.set_position([0.05, 0.2]);
        stream.line("G92 X0 Y0").unwrap();
        let [x, y] = stream.zero();
        assert!((x - 0.05).abs() < 1e-12 && (y - 0.2).abs() < 1e-12);
    }
}
