//! The interpreter: it keeps the modes from line to line and makes the steps.
//!
//! A job is interpreted twice: the first time shows which words move the tool and which dialect it
//! is in, the second time makes the steps by these rules.

use super::error::quoted;
use super::evidence::{Evidence, UNDECIDED};
use super::modes::{CoordinateUse, LineModes, Modes, MotionMode};
use super::motion::within_reach;
use super::options::Dialect;
use super::tool::{Activity, Rules, ToolState};
use super::words::{Line, Words, spelled};
use super::{Action, GcodeError, Job, JobError, JobOptions, Placement, Step, Stop, WarningKind};
use crate::budget::Budget;
use fivebar_firmware::planner::LONGEST;
use fivebar_kinematics::five_bar::{Side, WorkingMode};

/// A line of the file, read.
struct SourceLine<'a> {
    number: u32,
    text: &'a str,
    line: Result<Line, GcodeError>,
}

pub(super) fn interpret(
    text: &str,
    placement: &Placement,
    options: &JobOptions,
) -> Result<Job, JobError> {
    let lines = read(text);
    // An error of the first reading comes again in the second.
    let (_, evidence) = run(&lines, placement, options, UNDECIDED);
    let (rules, notes) = evidence.rules(options);
    let (job, _) = run(&lines, placement, options, rules);
    let mut job = job?;
    job.warnings.extend(notes);
    note_assembly(&mut job);
    note_purge(&mut job, &lines);
    job.warnings.sort_by_key(|warning| warning.line);
    let moves = |step: &Step| step.action.end().is_some();
    if job.steps.iter().any(moves) {
        Ok(job)
    } else {
        Err(JobError::NoMotion)
    }
}

/// Notes the last crossing of a job that ends in the other assembly mode than it begins in.
fn note_assembly(job: &mut Job) {
    let crosses = |step: &&Step| matches!(step.action, Action::Cross { .. });
    let crossings = job.steps.iter().filter(crosses);
    let line = crossings.clone().next_back().map(|step| step.line);
    if let Some(line) = line.filter(|_| crossings.count() % 2 == 1) {
        job.note(line, WarningKind::OtherAssembly);
    }
}

/// The axes of machines that turn or have a second tool.
const AXES_OF_OTHERS: [char; 6] = ['A', 'B', 'C', 'U', 'V', 'W'];

/// How slicers begin the comment before the first layer.
const LAYER: [&str; 3] = [";LAYER", "; CHANGE_LAYER", ";BEFORE_LAYER_CHANGE"];

/// Notes what a slicer draws before the first layer.
fn note_purge(job: &mut Job, lines: &[SourceLine<'_>]) {
    let begins_layer = |line: &&SourceLine<'_>| LAYER.iter().any(|it| line.text.starts_with(it));
    let Some(layer) = lines.iter().find(begins_layer).map(|line| line.number) else {
        return;
    };
    let mut drawn = job
        .steps
        .iter()
        .filter(|step| step.draws())
        .map(|step| step.line);
    if let Some(first) = drawn.next().filter(|&line| line < layer) {
        job.note(first, WarningKind::Purge(layer));
    }
}

/// The lines up to the end of the job, or to the first that is no G-code. They end with a line
/// feed, a carriage return or both.
fn read(text: &str) -> Vec<SourceLine<'_>> {
    let texts = text
        .split('\n')
        .flat_map(|line| line.strip_suffix('\r').unwrap_or(line).split('\r'));
    let mut lines = Vec::new();
    let mut budget = Budget::lines();
    for (number, text) in (1..).zip(texts) {
        let line = match budget.take(1) {
            Ok(()) => Line::read(text),
            Err(over) => Err(over.into()),
        };
        let is_last = line.as_ref().map_or(true, Line::ends);
        lines.push(SourceLine { number, text, line });
        if is_last {
            break;
        }
    }
    lines
}

fn run(
    lines: &[SourceLine<'_>],
    placement: &Placement,
    options: &JobOptions,
    rules: Rules,
) -> (Result<Job, JobError>, Evidence) {
    let mut interpreter = Interpreter {
        speed: options.speed,
        speed_without_feed: options.speed_without_feed,
        ..Interpreter::new(placement, rules)
    };
    for SourceLine { number, text, line } in lines {
        let done = match line {
            Ok(line) => interpreter.line(*number, line),
            Err(reason) => Err(reason.clone()),
        };
        if let Err(reason) = done {
            let error = JobError::Line {
                line: *number,
                text: quoted(text),
                reason,
            };
            return (Err(error), interpreter.evidence);
        }
    }
    (Ok(interpreter.job), interpreter.evidence)
}

#[derive(Clone)]
pub(super) struct Interpreter {
    pub(super) placement: Placement,
    pub(super) rules: Rules,
    /// The steps that the job may still have.
    pub(super) budget: Budget,
    pub(super) job: Job,
    pub(super) evidence: Evidence,
    pub(super) modes: Modes,
    pub(super) tool: ToolState,
    /// Speed by F [m/s].
    pub(super) feed: Option<f64>,
    /// Speed in place of that by F, and that before any F [m/s].
    pub(super) speed: Option<f64>,
    pub(super) speed_without_feed: Option<f64>,
    /// The tool's position in the job's frame, before placement [m].
    pub(super) position: [f64; 2],
    /// The position of X0 Y0 in the job's frame; G92 and G10 L20 move it [m].
    pub(super) zero: [f64; 2],
    /// The shift by G92, of X0 Y0 and of Z0, and the one that G92.3 sets again [m].
    pub(super) shift: [f64; 3],
    pub(super) stored_shift: [f64; 3],
    /// The end of the last motion as placed [m]; none before the first.
    pub(super) placed: Option<[f64; 2]>,
    /// Whether the coordinates go on at X0 Y0 after G28, as printers and slicers have it; else they go
    /// on where home is.
    pub(super) homes_to_zero: bool,
    /// Whether the tool is at home while the coordinates are at X0 Y0.
    pub(super) is_home: bool,
}

impl Interpreter {
    pub(super) fn new(placement: &Placement, rules: Rules) -> Self {
        Self {
            placement: *placement,
            rules,
            budget: Budget::points(),
            job: Job::default(),
            evidence: Evidence::new(),
            modes: Modes::new(),
            tool: ToolState::new(),
            feed: None,
            speed: None,
            speed_without_feed: None,
            position: [0.0; 2],
            zero: [0.0; 2],
            shift: [0.0; 3],
            stored_shift: [0.0; 3],
            placed: None,
            homes_to_zero: true,
            is_home: false,
        }
    }

    /// Interprets one line. As in every dialect, the parts of a line take effect in a fixed
    /// order: the tool, the modes, the feed rate in the units of these modes, then the motion.
    pub(super) fn line(&mut self, number: u32, line: &Line) -> Result<(), GcodeError> {
        let mut words = Words::of(line);
        if let Some(command) = &line.system_command {
            self.job
                .note(number, WarningKind::UnknownCode(command.clone()));
        }
        if line.is_deletable {
            self.job.note(number, WarningKind::BlockDelete);
        }
        if line.has_blanks {
            self.job.note(number, WarningKind::Blanks);
        }
        self.evidence.codes(number, line);
        self.miscellaneous(number, line)?;
        if let Some(sides) = line.elbows {
            self.elbows(number, sides)?;
        }
        if let Some(values) = line.crossing {
            self.crossing(number, values)?;
        }
        let LineModes {
            coordinate_use,
            machine,
            tool_length,
        } = self.modes.set(&line.general)?;
        if let Some(feed) = words.take('F') {
            if feed <= 0.0 {
                return Err(GcodeError::Feed);
            }
            self.feed = Some(feed * self.modes.unit / 60.0);
        }
        // The number of the program.
        words.take('O');
        let power = match coordinate_use {
            Some(CoordinateUse::Dwell) => None,
            _ => words.take('S'),
        };
        if power.is_some_and(|power| power < 0.0) {
            return Err(GcodeError::Power);
        }
        self.tool.speed = power.or(self.tool.speed);
        if tool_length {
            words.take('H');
            self.job.note(number, WarningKind::ToolLength);
        }
        match coordinate_use {
            Some(CoordinateUse::Dwell) => self.dwell(number, &mut words)?,
            Some(CoordinateUse::Home) => self.home(number, &mut words)?,
            Some(CoordinateUse::Shift) => self.shift(number, &mut words)?,
            Some(CoordinateUse::ShiftAgain(decimal)) => self.shift_again(number, decimal),
            Some(CoordinateUse::Table) => self.table(number, &mut words)?,
            Some(CoordinateUse::Motion(_)) | None => {
                self.motion(number, &mut words, machine, power)?;
            }
        }
        let steps = self.job.steps.len();
        if let Some(stop) = self.job.stops.last_mut()
            && stop.line == number
            && stop.ends_line()
        {
            stop.before = steps;
        }
        // The tolerance of G64.
        if line.general.contains(&('G', 64, 0)) {
            words.take('P');
            words.take('Q');
        }
        for axis in AXES_OF_OTHERS {
            match words.take(axis) {
                None => {}
                Some(0.0) => self.job.note(number, WarningKind::NoAxis(axis)),
                Some(_) => return Err(GcodeError::NoAxis(axis)),
            }
        }
        match words.left_over() {
            Some(letter) => Err(GcodeError::StrayWord(letter)),
            None => Ok(()),
        }
    }

    fn miscellaneous(&mut self, number: u32, line: &Line) -> Result<(), GcodeError> {
        let mut stops = String::new();
        for &(code, value) in &line.miscellaneous {
            match code {
                ('M', 2 | 30 | 7 | 8 | 9, 0) => {}
                ('M', 0 | 1 | 6, 0) | ('T', ..) => {
                    if !stops.is_empty() {
                        stops.push(' ');
                    }
                    stops += &spelled(code);
                }
                ('M', 97..=99, _) => return Err(GcodeError::Subprogram(spelled(code))),
                ('M', known, 0) if self.tool.apply(known, value) => {}
                unknown => {
                    let kind = WarningKind::UnknownCode(spelled(unknown));
                    self.job.note(number, kind);
                }
            }
        }
        if !stops.is_empty() {
            self.job.stops.push(Stop {
                line: number,
                before: self.job.steps.len(),
                code: stops.clone(),
                name: line.comment.clone(),
            });
            self.job.note(number, WarningKind::Stop(stops));
        }
        Ok(())
    }

    /// M780: the elbows go to these sides, and the tool goes back to its place.
    fn elbows(&mut self, number: u32, sides: [Option<f64>; 2]) -> Result<(), GcodeError> {
        let side = |value: Option<f64>| match value {
            Some(1.0) => Ok(Side::Left),
            Some(-1.0) => Ok(Side::Right),
            _ => Err(GcodeError::Elbows),
        };
        let [elbow1, elbow4] = sides;
        let mode = WorkingMode::new(side(elbow1)?, side(elbow4)?);
        self.begin()?;
        self.push(number, 0.0, Action::ChangeMode(mode))
    }

    /// M781: the tool goes straight to a point, through a singularity to the other assembly mode.
    fn crossing(&mut self, number: u32, values: [Option<f64>; 3]) -> Result<(), GcodeError> {
        let [Some(x), Some(y), Some(time)] = values else {
            return Err(GcodeError::Crossing);
        };
        if !(time > 0.0 && time.is_finite()) {
            return Err(GcodeError::Crossing);
        }
        self.begin()?;
        let from = if self.modes.relative {
            self.position
        } else {
            self.zero
        };
        for (axis, value) in [x, y].into_iter().enumerate() {
            self.position[axis] = within_reach(from[axis] + value * self.modes.unit)?;
        }
        let to = self.place(self.position)?;
        self.placed = Some(to);
        self.push(number, 0.0, Action::Cross { to, time })
    }

    fn dwell(&mut self, number: u32, words: &mut Words) -> Result<(), GcodeError> {
        let dialect = self.rules.dialect;
        let by_p = words.take('P').map(|p| match dialect {
            Dialect::Grbl => p,
            Dialect::RepRap => 1e-3 * p,
        });
        if by_p.is_some_and(|duration| duration != 0.0) {
            self.evidence.dwell = self.evidence.dwell.or(Some(number));
        }
        let error = GcodeError::Dwell(dialect);
        let Some(duration) = by_p.or_else(|| words.take('S')) else {
            return Err(error);
        };
        if !(0.0..=f64::from(LONGEST)).contains(&duration) {
            return Err(error);
        }
        if duration > 0.0 {
            let activity = match self.modes.motion {
                None | Some(MotionMode::Rapid) => Activity::RestAfterRapid,
                Some(_) => Activity::RestAfterFeed,
            };
            let tool = self.tool.level(&self.rules, activity);
            self.push(number, tool, Action::Dwell { duration })?;
        }
        Ok(())
    }

    /// G28: the tool goes home in x and y, whichever of them is named, because the arm's
    /// joints cannot move along one axis alone. With Z alone it is lifted only.
    fn home(&mut self, number: u32, words: &mut Words) -> Result<(), GcodeError> {
        let named = ['X', 'Y', 'Z'].map(|letter| words.take(letter).is_some());
        if named[2] || named == [false; 3] {
            self.tool.z = None;
        }
        if named == [false, false, true] {
            return Ok(());
        }
        self.tool.extrudes = false;
        self.job.depends_on_home = true;
        self.position = self.placement.unplace(self.placement.home);
        let tool = self.tool.level(&self.rules, Activity::Rapid);
        self.go(number, tool, None)?;
        if self.homes_to_zero {
            self.position = [0.0; 2];
            self.is_home = true;
        }
        Ok(())
    }

    /// G92: gives the tool's present position these coordinates.
    fn shift(&mut self, number: u32, words: &mut Words) -> Result<(), GcodeError> {
        let named = ['X', 'Y'].map(|letter| words.take(letter));
        let (z, e) = (words.take('Z'), words.take('E'));
        let none = named == [None; 2] && z.is_none() && e.is_none();
        for (axis, value) in named.into_iter().enumerate() {
            // Without coordinates, the present position becomes (0, 0).
            if let Some(value) = if none { Some(0.0) } else { value } {
                let value = within_reach(value * self.modes.unit)?;
                let zero = self.position[axis] - value;
                self.shift[axis] += zero - self.zero[axis];
                self.zero[axis] = zero;
            }
        }
        if let Some(z) = z {
            let z = within_reach(z * self.modes.unit)?;
            self.shift[2] += self.tool.z.map_or(0.0, |before| before - z);
            self.set_z(number, z);
        }
        if let Some(e) = e {
            self.tool.set_e(e);
        }
        Ok(())
    }

    /// G92.1 and G92.2 take the shift by G92 back, and G92.2 keeps it for G92.3, which sets it again.
    fn shift_again(&mut self, number: u32, decimal: u32) {
        let next = match decimal {
            3 => self.stored_shift,
            _ => [0.0; 3],
        };
        if decimal < 3 {
            self.stored_shift = match decimal {
                2 => self.shift,
                _ => [0.0; 3],
            };
        }
        for (zero, (next, shift)) in self.zero.iter_mut().zip(next.iter().zip(&self.shift)) {
            *zero += next - shift;
        }
        if let Some(z) = self.tool.z.filter(|_| next[2] != self.shift[2]) {
            self.set_z(number, z + self.shift[2] - next[2]);
        }
        self.shift = next;
    }

    /// G10 L20 gives the tool's present position these coordinates, as G92 does, but in the work coordinate system
    /// itself. Offsets of tools change nothing here.
    fn table(&mut self, number: u32, words: &mut Words) -> Result<(), GcodeError> {
        let [table, entry] = ['L', 'P'].map(|letter| words.take(letter));
        let in_use = self.modes.system();
        let name = match table {
            Some(table) => format!("G10 L{table}"),
            None => "G10".into(),
        };
        if table.is_some_and(|table| [1.0, 10.0, 11.0].contains(&table)) {
            for letter in ['X', 'Y', 'Z', 'R', 'I', 'J', 'Q'] {
                words.take(letter);
            }
            self.job.note(number, WarningKind::UnknownCode(name));
            return Ok(());
        }
        if table != Some(20.0) {
            let why = "changes an offset from the machine's zero, which is not known here: use G92 \
                       or G10 L20";
            return Err(GcodeError::ChangesDrawing(name, why));
        }
        if entry.is_some_and(|entry| entry != 0.0 && entry != f64::from(in_use)) {
            let why =
                "sets a work coordinate system that is not in use: select it before, as by G54";
            return Err(GcodeError::ChangesDrawing(name, why));
        }
        for (axis, letter) in ['X', 'Y'].into_iter().enumerate() {
            if let Some(value) = words.take(letter) {
                let value = within_reach(value * self.modes.unit)?;
                self.zero[axis] = self.position[axis] - value;
            }
        }
        if let Some(z) = words.take('Z') {
            self.set_z(number, within_reach(z * self.modes.unit)?);
        }
        Ok(())
    }

    /// The speed of G1, G2 and G3 [m/s].
    pub(super) fn speed(&mut self, number: u32) -> Result<f64, GcodeError> {
        match (self.speed, self.feed) {
            (Some(speed), feed) => {
                if feed.is_some() {
                    self.job.note(number, WarningKind::FeedReplaced);
                }
                Ok(speed)
            }
            (None, Some(feed)) => Ok(feed),
            (None, None) => {
                let speed = self.speed_without_feed.ok_or(GcodeError::NoFeed)?;
                self.job.note(number, WarningKind::NoFeed);
                Ok(speed)
            }
        }
    }
}
