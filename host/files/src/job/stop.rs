//! Stops: where a job waits for its user, as for a change of the pen.

use super::Job;
use fivebar_firmware::{Move, MoveKind};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Time that the tool gets to switch off while the arm rests [s]. The planner waits for a servo.
const LEVEL_CHANGE: f32 = 1e-3;

/// A stop by M0, M1, M6 or T, or between the pens of a drawing. A machine waits there for its user;
/// a simulation goes on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stop {
    /// The line of the file, from 1.
    pub line: u32,
    /// The number of steps before it.
    pub before: usize,
    /// The codes: "M0", "M6 T2"; "Pen change" in a drawing.
    pub code: String,
    /// What the user is to do: the comment of the line; a drawing's layer, colour or pen.
    pub name: Option<String>,
}

impl Stop {
    /// Whether it comes behind the motion of its line: M0 and M1. A tool is changed before it.
    pub fn ends_line(&self) -> bool {
        self.code.starts_with("M0") || self.code.starts_with("M1")
    }

    /// Whether a move of this line comes after it.
    fn is_before(&self, line: u32) -> bool {
        line > self.line || line == self.line && !self.ends_line()
    }
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.name {
            Some(name) => write!(f, "{}: {name}", self.code),
            None => f.write_str(&self.code),
        }
    }
}

/// A stop among the moves of a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pause {
    /// The number of moves before it.
    pub before: usize,
    /// The stops there, as a text.
    pub text: String,
}

impl Job {
    /// Moves of this job, each tagged with its line, with the pauses among them. The last move before a
    /// pause lifts the tool. A stop before the job's first motion or behind the last one is no pause: there is
    /// nothing to interrupt.
    pub fn with_pauses(&self, moves: &[Move]) -> (Vec<Move>, Vec<Pause>) {
        let mut all = Vec::with_capacity(moves.len() + self.stops.len());
        let mut pauses: Vec<Pause> = Vec::new();
        let mut rest = moves;
        for stop in &self.stops {
            let (before, behind) =
                rest.split_at(rest.partition_point(|it| !stop.is_before(it.tag)));
            all.extend_from_slice(before);
            rest = behind;
            let begins = all.iter().any(|it| it.tag > 0);
            if !begins || rest.is_empty() {
                continue;
            }
            match pauses.last_mut().filter(|last| last.before == all.len()) {
                Some(same) => same.text += &format!(", {stop}"),
                None => {
                    let duration = LEVEL_CHANGE;
                    all.push(Move {
                        tag: stop.line,
                        tool: 0,
                        kind: MoveKind::Dwell { duration },
                    });
                    pauses.push(Pause {
                        before: all.len(),
                        text: stop.to_string(),
                    });
                }
            }
        }
        all.extend_from_slice(rest);
        (all, pauses)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Job, Placement};
    use fivebar_firmware::MoveKind;

    const PLACEMENT: Placement = Placement {
        origin: [0.0; 2],
        scale: 1.0,
        turn: 0.0,
        home: [0.0; 2],
    };

    fn pauses(text: &str) -> Vec<(usize, String)> {
        let job = Job::parse(text, &PLACEMENT).unwrap();
        let moves: Vec<_> = job.moves(0.1).collect();
        let (all, pauses) = job.with_pauses(&moves);
        assert_eq!(all.len(), moves.len() + pauses.len());
        for pause in &pauses {
            let last = all[pause.before - 1];
            assert!(last.tool == 0 && matches!(last.kind, MoveKind::Dwell { .. }));
        }
        pauses.into_iter().map(|it| (it.before, it.text)).collect()
    }

    #[test]
    fn a_job_pauses_between_motions_with_the_tool_up_and_says_why() {
        let text =
            "F600\nT1 M6\nG1 X1\nG1 X2 M0 (the red pen)\nM0 ; look\nG1 X3 M6 T2\nG1 X4\nM0\nM30";
        let why = "M0: the red pen, M0: look, M6 T2";
        // The first move leads to X0 Y0.
        assert_eq!(pauses(text), [(4, why.into())]);
    }

    #[test]
    fn a_plot_pauses_between_its_pens() {
        let plot = "IN;SP1;PU0,0;PD400,0;SP3;PU0,400;PD400,400;SP1;PU0,800;PD400,800;";
        assert_eq!(pauses(plot), [(5, "Pen change: pen 3".into())]);
    }
}
