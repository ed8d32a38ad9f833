//! HPGL plots as jobs, as plotters and cutters take them: pens, lines, circles, arcs, curves, rectangles and wedges.
//!
//! A unit is 0.025 mm, x is to the right, y up. What would change the drawing is refused with the
//! number of its command; labels are left out and noted.

mod arcs;
mod command;

use super::drawing::{self, Stroke};
use super::motion::within_reach;
use super::{Job, JobError, JobOptions, Placement, Step, Warning, WarningKind};
use crate::budget::Budget;
use command::{Command, commands};

/// Metres per unit.
const UNIT: f64 = 25e-6;
/// Greatest number of a pen.
const LAST_PEN: f64 = 255.0;

/// Commands that change no line: the chords of arcs, whose tolerance is the arm's, speed, force, widths, fonts, fills, formats of the page.
const WITHOUT_LINES: &str = "CT VS FS PT PW WU LA CO NP PC BP PS MC SD AD SS SA SI SR DI DR DT SL ES FT \
    LO DV AF PG RP NR TL IM IV OE OI OS OA OC OD OF OH OO OP OW AS AP CS CA UL SB TR MG EC MT QL CR CV EP";
/// Commands with numbers, whose count was wrong if nothing else has read them.
const WITH_NUMBERS: &str = "CI AA AR AT RT EA ER EW BZ BR IP SC RO PM";
/// Commands that would draw otherwise than they are read here.
const REFUSED: &str = "PE XT YT SM UC PB";

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
        let reason = "the plot draws nothing: no PD, CI, EA or EW with a pen";
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
    /// Quarter turns of the axes by RO, counter-clockwise.
    turns: u8,
    /// Those under which the first line was drawn.
    turns_drawn: Option<u8>,
    /// Where a polygon of PM begins, in the file's units; PM1 and PM2 close it.
    polygon: Option<[f64; 2]>,
    /// Whether PM1 stands before: the next line goes to another polygon with the pen up.
    is_between_polygons: bool,
    budget: Budget,
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
            turns: 0,
            turns_drawn: None,
            polygon: None,
            is_between_polygons: false,
            budget: Budget::points(),
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
                self.turns = 0;
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
                self.arc(self.behind([x, y]), angle, self.is_down)?;
            }
            ("AT", &[x1, y1, x2, y2] | &[x1, y1, x2, y2, _]) => {
                self.arc_through([x1, y1], [x2, y2])?;
            }
            ("RT", &[x1, y1, x2, y2] | &[x1, y1, x2, y2, _]) => {
                self.arc_through(self.behind([x1, y1]), self.behind([x2, y2]))?;
            }
            ("EW", &[radius, start, sweep] | &[radius, start, sweep, _]) => {
                self.wedge(radius, start, sweep)?;
            }
            ("BZ" | "BR", numbers) if numbers.len().is_multiple_of(6) && !numbers.is_empty() => {
                self.curves(numbers, command.name == "BR")?;
            }
            ("EA", &[x, y]) => self.rectangle([x, y])?,
            ("ER", &[x, y]) => self.rectangle(self.behind([x, y]))?,
            ("IP", &[x1, y1, x2, y2]) => self.corners = Some([x1, y1, x2, y2]),
            ("IP", []) => self.corners = None,
            ("SC", []) => self.rescale([UNIT; 2], [0.0; 2])?,
            ("SC", &[left, right, low, high] | &[left, right, low, high, 0.0]) => {
                self.scaled([left, right], [low, high])?;
            }
            ("RO", []) => self.turn(0.0)?,
            ("RO", &[angle]) => self.turn(angle)?,
            ("PM", &[] | &[0.0 | 1.0 | 2.0]) => self.polygon(numbers)?,
            ("IW" | "LT", []) => {}
            ("LT", _) => self.note("dashed lines are drawn whole"),
            ("LB", _) => self.note("labels of LB are left out: convert them to lines"),
            ("FP" | "RA" | "RR" | "WG", _) => self.note("fills are left out"),
            ("IW", _) => self.note("the window of IW does not cut the lines"),
            (name, _) if is_in(WITHOUT_LINES, name) => {}
            (name, _) if is_in(WITH_NUMBERS, name) => {
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

    /// Turns the axes. What was drawn under other axes would have to be moved as the plotter moves its zero,
    /// which differs from plotter to plotter.
    fn turn(&mut self, angle: f64) -> Result<(), String> {
        let turns = angle / 90.0;
        if !(0.0..=3.0).contains(&turns) || turns.fract() != 0.0 {
            return Err("a plot is turned by 0, 90, 180 or 270 degrees".into());
        }
        if turns > 0.0 {
            self.note("the plot is turned by RO");
        }
        let place = self.placed(self.at)?;
        self.turns = turns as u8;
        self.at = self.unplaced(place);
        Ok(())
    }

    /// A position that is given from the present one.
    fn behind(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.at[0] + x, self.at[1] + y]
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

    /// Begins a polygon, or ends a part of it or the whole: plotters add the line to its beginning.
    fn polygon(&mut self, mode: &[f64]) -> Result<(), String> {
        let (is_end, is_whole) = (matches!(mode, [1.0 | 2.0]), mode == [2.0]);
        if let Some(start) = self.polygon.filter(|&start| is_end && start != self.at)
            && !self.is_between_polygons
        {
            self.line(start, self.is_down)?;
        }
        self.is_between_polygons = mode == [1.0];
        self.polygon = Some(self.at).filter(|_| !is_whole);
        Ok(())
    }

    fn line(&mut self, to: [f64; 2], draws: bool) -> Result<(), String> {
        let [start, end] = [self.placed(self.at)?, self.placed(to)?];
        self.at = to;
        if std::mem::take(&mut self.is_between_polygons) {
            self.polygon = Some(to);
            self.is_open = false;
            return Ok(());
        }
        let Some(number) = self.pen.filter(|_| draws) else {
            return Ok(());
        };
        if *self.turns_drawn.get_or_insert(self.turns) != self.turns {
            return Err("RO turns the plot after lines were drawn: export it unturned".into());
        }
        self.budget.take(1)?;
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

    fn scaled(&mut self, [left, right]: [f64; 2], [low, high]: [f64; 2]) -> Result<(), String> {
        let Some([x1, y1, x2, y2]) = self.corners else {
            let [width, height] = [right - left, high - low].map(f64::abs);
            return Err(format!(
                "its units depend on the plotter's P1 and P2, which no IP states: put a command \
                 with their places in 0.025 mm before it, such as IP0,0,{width},{height}"
            ));
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
        self.at = self.unplaced(place);
        Ok(())
    }

    /// A position [m].
    fn placed(&self, at: [f64; 2]) -> Result<[f64; 2], String> {
        let [x, y] = [0, 1].map(|axis| {
            within_reach(self.zero[axis] + self.scale[axis] * at[axis])
                .map_err(|error| error.to_string())
        });
        Ok(turned([x?, y?], self.turns))
    }

    /// The position that [`Self::placed`] takes to a place [m].
    fn unplaced(&self, place: [f64; 2]) -> [f64; 2] {
        let place = turned(place, 4 - self.turns);
        [0, 1].map(|axis| (place[axis] - self.zero[axis]) / self.scale[axis])
    }

    fn note(&mut self, what: &'static str) {
        let kind = WarningKind::Drawing(what.into());
        match self.notes.iter_mut().find(|note| note.kind == kind) {
            Some(same) => same.count += 1,
            None => self.notes.push(Warning::at(0, kind)),
        }
    }
}

/// A point after quarter turns about (0, 0), counter-clockwise.
fn turned(point: [f64; 2], turns: u8) -> [f64; 2] {
    (0..turns).fold(point, |[x, y], _| [-y, x])
}

fn is_in(list: &str, name: &str) -> bool {
    list.split(' ').any(|other| other == name)
}
