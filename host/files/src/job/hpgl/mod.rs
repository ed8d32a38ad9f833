//! HPGL plots as jobs, as plotters and cutters take them: pens, lines, circles, arcs and rectangles.
//!
//! A unit is 0.025 mm, x is to the right, y up. What would change the drawing is refused with the
//! number of its command; labels are left out and noted.

mod command;

use super::drawing::{self, Stroke};
use super::motion::within_reach;
use super::{Job, JobError, JobOptions, Placement, Step, Warning, WarningKind};
use command::{Command, commands};
use std::f64::consts::TAU;

/// Metres per unit.
const UNIT: f64 = 25e-6;
/// Most points of a plot.
const MOST_POINTS: usize = 1_000_000;
/// Greatest number of a pen.
const LAST_PEN: f64 = 255.0;

/// Commands that change no line: speed, force, widths, fonts, fills, formats of the page.
const WITHOUT_LINES: &str = "VS FS PT PW WU LA CO NP PC BP PS MC SD AD SS SA SI SR DI DR DT SL ES FT \
    LO DV AF PG RP NR TL IM IV OE OI OS OA OC OD OF OH OO OP OW AS AP CS CA UL SB TR MG EC MT QL CR CV PM EP";
/// Commands that would draw otherwise than they are read here.
const REFUSED: &str = "PE AT RT EW WG BZ BR XT YT SM UC PB";

pub(super) fn interpret(
    text: &str,
    placement: &Placement,
    options: &JobOptions,
) -> Result<Job, JobError> {
    let mut plot = Plot::new(options.tolerance);
    for (number, command) in (1..).zip(commands(text)) {
        plot.command(&command).map_err(|reason| {
            JobError::Drawing(format!("command {number}, {}: {reason}", command.name))
        })?;
    }
    let mut pens = plot.pens;
    pens.retain(|pen| !pen.strokes.is_empty());
    let pens = pens.into_iter().map(|pen| drawing::Pen {
        name: format!("pen {}", pen.number),
        strokes: pen.strokes,
    });
    let job = drawing::job(pens.collect(), plot.notes, placement, options)?;
    if job.steps.iter().any(Step::draws) {
        Ok(job)
    } else {
        let reason = "the plot draws nothing: no PD, CI, AA or EA with a pen";
        Err(JobError::Drawing(reason.into()))
    }
}

struct Pen {
    number: u8,
    strokes: Vec<Stroke>,
}

/// A plot that is being read.
struct Plot {
    /// Greatest distance of lines from arcs [m].
    tolerance: f64,
    pens: Vec<Pen>,
    /// The pen in use; none after SP0.
    pen: Option<u8>,
    is_down: bool,
    relative: bool,
    /// The position in the file's units.
    at: [f64; 2],
    /// P1 and P2 by IP [units].
    corners: Option<[f64; 4]>,
    /// Metres per unit and the position of (0, 0) [m].
    scale: [f64; 2],
    zero: [f64; 2],
    /// Whether the last stroke of the pen ends at the position.
    is_open: bool,
    points: usize,
    notes: Vec<Warning>,
}

impl Plot {
    fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            pens: Vec::new(),
            pen: Some(1),
            is_down: false,
            relative: false,
            at: [0.0; 2],
            corners: None,
            scale: [UNIT; 2],
            zero: [0.0; 2],
            is_open: false,
            points: 0,
            notes: Vec::new(),
        }
    }

    fn command(&mut self, command: &Command) -> Result<(), String> {
        let numbers = &command.numbers[..];
        match (command.name.as_str(), numbers) {
            ("IN" | "DF", _) => {
                self.lift();
                (self.relative, self.corners) = (false, None);
                (self.scale, self.zero) = ([UNIT; 2], [0.0; 2]);
                if command.name == "IN" {
                    self.at = [0.0; 2];
                }
            }
            ("SP", _) => self.choose(numbers.first().copied().unwrap_or(0.0))?,
            ("PU", _) => {
                self.lift();
                self.lines(numbers)?;
            }
            ("PD", _) => {
                self.is_down = true;
                self.lines(numbers)?;
            }
            ("PA" | "PR", _) => {
                self.relative = command.name == "PR";
                self.lines(numbers)?;
            }
            ("CI", &[radius] | &[radius, _]) => {
                let middle = self.at;
                self.is_open = false;
                self.at = [middle[0] + radius, middle[1]];
                self.arc(middle, 360.0, true)?;
                self.at = middle;
                self.is_open = false;
            }
            ("AA", &[x, y, angle] | &[x, y, angle, _]) => self.arc([x, y], angle, self.is_down)?,
            ("AR", &[x, y, angle] | &[x, y, angle, _]) => {
                self.arc([self.at[0] + x, self.at[1] + y], angle, self.is_down)?;
            }
            ("EA", &[x, y]) => self.rectangle([x, y])?,
            ("ER", &[x, y]) => self.rectangle([self.at[0] + x, self.at[1] + y])?,
            ("IP", &[x1, y1, x2, y2]) => self.corners = Some([x1, y1, x2, y2]),
            ("IP", []) => self.corners = None,
            ("SC", []) => self.rescale([UNIT; 2], [0.0; 2])?,
            ("SC", &[left, right, low, high] | &[left, right, low, high, 0.0]) => {
                self.scaled([left, right], [low, high])?;
            }
            ("RO", [] | [0.0]) | ("IW", []) => {}
            ("LT", []) => {}
            ("LT", _) => self.note("dashed lines are drawn whole"),
            ("LB", _) => self.note("labels of LB are left out: convert them to lines"),
            ("FP" | "RA" | "RR", _) => self.note("fills are left out"),
            ("IW", _) => self.note("the window of IW does not cut the lines"),
            ("RO", _) => return Err("turn the plot when it is exported, or with --rotate".into()),
            (name, _) if is_in(WITHOUT_LINES, name) => {}
            ("CI" | "AA" | "AR" | "EA" | "ER" | "IP" | "SC", _) => {
                return Err(format!("{} numbers do not suit it", numbers.len()));
            }
            (name, _) if is_in(REFUSED, name) => {
                return Err(
                    "it is not read: export plain HPGL with PU, PD and PA, or an SVG".into(),
                );
            }
            _ => {
                return Err("it is no command of HPGL that is known".into());
            }
        }
        Ok(())
    }

    fn choose(&mut self, pen: f64) -> Result<(), String> {
        if !(0.0..=LAST_PEN).contains(&pen) {
            return Err(format!("a pen has a number from 0 to {LAST_PEN}"));
        }
        self.lift();
        self.pen = Some(pen as u8).filter(|&pen| pen > 0);
        Ok(())
    }

    fn lift(&mut self) {
        self.is_down = false;
        self.is_open = false;
    }

    fn lines(&mut self, numbers: &[f64]) -> Result<(), String> {
        if !numbers.len().is_multiple_of(2) {
            return Err("a coordinate is missing: they come in pairs".into());
        }
        for pair in numbers.chunks_exact(2) {
            let from = if self.relative { self.at } else { [0.0; 2] };
            self.line([from[0] + pair[0], from[1] + pair[1]], self.is_down)?;
        }
        Ok(())
    }

    fn line(&mut self, to: [f64; 2], draws: bool) -> Result<(), String> {
        let [start, end] = [self.placed(self.at)?, self.placed(to)?];
        self.at = to;
        let Some(number) = self.pen.filter(|_| draws) else {
            return Ok(());
        };
        self.points += 1;
        if self.points > MOST_POINTS {
            return Err(format!(
                "the plot has more than {MOST_POINTS} points: simplify it"
            ));
        }
        let known = self.pens.iter().position(|pen| pen.number == number);
        let index = known.unwrap_or(self.pens.len());
        if known.is_none() {
            let strokes = Vec::new();
            self.pens.push(Pen { number, strokes });
        }
        let pen = &mut self.pens[index];
        match pen.strokes.last_mut().filter(|_| self.is_open) {
            Some(stroke) => stroke.push(end),
            None => pen.strokes.push(vec![start, end]),
        }
        self.is_open = true;
        Ok(())
    }

    /// An arc by an angle [degrees], counter-clockwise, as lines.
    fn arc(&mut self, middle: [f64; 2], angle: f64, draws: bool) -> Result<(), String> {
        let [x, y] = [self.at[0] - middle[0], self.at[1] - middle[1]];
        let metres = x.hypot(y) * self.scale[0].abs().max(self.scale[1].abs());
        within_reach(metres).map_err(|error| error.to_string())?;
        let sweep = angle.clamp(-360.0, 360.0) / 360.0 * TAU;
        // The sagitta of a chord over 2a is r (1 − cos a) ≤ r a²/2.
        let half = (2.0 * self.tolerance / metres.max(self.tolerance)).sqrt();
        let count = (sweep.abs() / (2.0 * half)).ceil().max(8.0);
        for step in 1..=count as u32 {
            let (sin, cos) = (sweep * f64::from(step) / count).sin_cos();
            let to = [middle[0] + cos * x - sin * y, middle[1] + sin * x + cos * y];
            self.line(to, draws)?;
        }
        Ok(())
    }

    /// A rectangle from the position to the opposite corner. The pen goes back to where it was.
    fn rectangle(&mut self, [x, y]: [f64; 2]) -> Result<(), String> {
        let [left, low] = self.at;
        self.is_open = false;
        for to in [[x, low], [x, y], [left, y], [left, low]] {
            self.line(to, true)?;
        }
        self.is_open = false;
        Ok(())
    }

    fn scaled(&mut self, [left, right]: [f64; 2], [low, high]: [f64; 2]) -> Result<(), String> {
        let Some([x1, y1, x2, y2]) = self.corners else {
            return Err("its units depend on the plotter's P1 and P2, which no IP states".into());
        };
        let scale = [(x2 - x1) / (right - left), (y2 - y1) / (high - low)];
        if !scale.iter().all(|it| it.is_normal()) {
            return Err("a side of its frame is zero".into());
        }
        let scale = scale.map(|it| it * UNIT);
        let zero = [UNIT * x1 - scale[0] * left, UNIT * y1 - scale[1] * low];
        self.rescale(scale, zero)
    }

    /// Changes the units. The position stays where it is.
    fn rescale(&mut self, scale: [f64; 2], zero: [f64; 2]) -> Result<(), String> {
        let place = self.placed(self.at)?;
        (self.scale, self.zero) = (scale, zero);
        self.at = [0, 1].map(|axis| (place[axis] - zero[axis]) / scale[axis]);
        Ok(())
    }

    /// A position [m].
    fn placed(&self, at: [f64; 2]) -> Result<[f64; 2], String> {
        let [x, y] = [0, 1].map(|axis| {
            within_reach(self.zero[axis] + self.scale[axis] * at[axis])
                .map_err(|error| error.to_string())
        });
        Ok([x?, y?])
    }

    fn note(&mut self, what: &'static str) {
        let kind = WarningKind::Drawing(what);
        match self.notes.iter_mut().find(|note| note.kind == kind) {
            Some(same) => same.count += 1,
            None => self.notes.push(Warning::at(0, kind)),
        }
    }
}

fn is_in(list: &str, name: &str) -> bool {
    list.split(' ').any(|other| other == name)
}
