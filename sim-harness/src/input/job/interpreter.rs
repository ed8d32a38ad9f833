//! The interpreter: it keeps the modes from line to line and makes the steps.

use super::error::quoted;
use super::words::{Code, Line, spelled};
use super::{Action, GcodeError, Job, JobError, Placement, Step, Warning, WarningKind, arc};
use fivebar_firmware::planner::LONGEST;

/// Coordinates beyond this [m] are a mistake in the units.
const MAX_COORDINATE: f64 = 1e3;
/// Shorter motions [m] are dropped: their ends may be the same in `f32`.
const MIN_LENGTH: f64 = 1e-7;
/// M300 S up to this puts the pen down, above it lifts it (S255 turns its servo off).
const PEN_DOWN_ANGLE: f64 = 40.0;

pub(super) fn interpret(text: &str, placement: &Placement) -> Result<Job, JobError> {
    let mut interpreter = Interpreter::new(placement);
    for (number, text) in (1..).zip(text.lines()) {
        let ended = interpreter
            .line(number, text)
            .map_err(|reason| JobError::Line {
                line: number,
                text: quoted(text),
                reason,
            })?;
        if ended {
            break;
        }
    }
    let moves = |step: &Step| !matches!(step.action, Action::Dwell { .. });
    if interpreter.job.steps.iter().any(moves) {
        Ok(interpreter.job)
    } else {
        Err(JobError::NoMotion)
    }
}

/// The motion mode. It lasts until another one is set.
#[derive(Clone, Copy, PartialEq)]
enum MotionMode {
    Rapid,
    Line,
    Clockwise,
    CounterClockwise,
}

/// What a line does with its coordinates.
#[derive(Clone, Copy, PartialEq)]
enum CoordinateUse {
    Motion(MotionMode),
    Dwell,
    Home,
    Shift,
}

struct Interpreter<'a> {
    placement: &'a Placement,
    job: Job,
    /// Metres per unit of the file.
    unit: f64,
    relative: bool,
    motion: Option<MotionMode>,
    /// Speed [m/s].
    feed: Option<f64>,
    /// The tool's level, 0…1.
    tool: f64,
    /// The tool's position in the job's frame, before placement [m].
    position: [f64; 2],
    /// The position of X0 Y0 in the job's frame; G92 moves it [m].
    zero: [f64; 2],
    /// The end of the last motion as placed [m]; none before the first.
    placed: Option<[f64; 2]>,
    height_warned: bool,
}

impl<'a> Interpreter<'a> {
    fn new(placement: &'a Placement) -> Self {
        Self {
            placement,
            job: Job {
                steps: Vec::new(),
                warnings: Vec::new(),
            },
            unit: 1e-3,
            relative: false,
            motion: None,
            feed: None,
            tool: 0.0,
            position: [0.0; 2],
            zero: [0.0; 2],
            placed: None,
            height_warned: false,
        }
    }

    /// Interprets one line; returns whether it ends the job. As in every dialect, the parts
    /// of a line take effect in a fixed order: the pen, the modes, the feed rate in the units
    /// of these modes, then the motion.
    fn line(&mut self, number: u32, text: &str) -> Result<bool, GcodeError> {
        let mut line = Line::read(text)?;
        let mut ends = false;
        for &(code, speed) in &line.miscellaneous {
            match code {
                ('M', 2 | 30, 0) => ends = true,
                ('M', 3 | 4, 0) => self.tool = 1.0,
                ('M', 5, 0) => self.tool = 0.0,
                ('M', 300, 0) if speed.is_some() => {
                    let down = speed.is_some_and(|angle| angle <= PEN_DOWN_ANGLE);
                    self.tool = f64::from(u8::from(down));
                }
                unknown => self.warn(number, WarningKind::UnknownCode(spelled(unknown))),
            }
        }
        let coordinate_use = self.modes(&line.general)?;
        if let Some(feed) = line.take('F') {
            if feed <= 0.0 {
                return Err(GcodeError::Feed);
            }
            self.feed = Some(feed * self.unit / 60.0);
        }
        match coordinate_use {
            Some(CoordinateUse::Dwell) => self.dwell(number, &mut line)?,
            Some(CoordinateUse::Home) => self.home(number, &mut line)?,
            Some(CoordinateUse::Shift) => self.shift(number, &mut line)?,
            Some(CoordinateUse::Motion(_)) | None => self.motion(number, &mut line)?,
        }
        // A spindle's speed; a pen has none.
        line.take('S');
        match line.left_over() {
            Some(letter) => Err(GcodeError::StrayWord(letter)),
            None => Ok(ends),
        }
    }

    /// Sets the modes; returns what the line does with its coordinates.
    fn modes(&mut self, codes: &[Code]) -> Result<Option<CoordinateUse>, GcodeError> {
        let mut coordinate_use: Option<(CoordinateUse, Code)> = None;
        for &code in codes {
            let action = match code {
                ('G', 0, 0) => CoordinateUse::Motion(MotionMode::Rapid),
                ('G', 1, 0) => CoordinateUse::Motion(MotionMode::Line),
                ('G', 2, 0) => CoordinateUse::Motion(MotionMode::Clockwise),
                ('G', 3, 0) => CoordinateUse::Motion(MotionMode::CounterClockwise),
                ('G', 4, 0) => CoordinateUse::Dwell,
                ('G', 28, 0) => CoordinateUse::Home,
                ('G', 92, 0) => CoordinateUse::Shift,
                ('G', 20, 0) => {
                    self.unit = 25.4e-3;
                    continue;
                }
                ('G', 21, 0) => {
                    self.unit = 1e-3;
                    continue;
                }
                ('G', 90, 0) => {
                    self.relative = false;
                    continue;
                }
                ('G', 91, 0) => {
                    self.relative = true;
                    continue;
                }
                unknown => return Err(GcodeError::UnknownGCode(spelled(unknown))),
            };
            if let Some((_, other)) = coordinate_use {
                return Err(GcodeError::Conflict(spelled(other), spelled(code)));
            }
            coordinate_use = Some((action, code));
        }
        if let Some((CoordinateUse::Motion(motion), _)) = coordinate_use {
            self.motion = Some(motion);
        }
        Ok(coordinate_use.map(|(action, _)| action))
    }

    fn dwell(&mut self, number: u32, line: &mut Line) -> Result<(), GcodeError> {
        let milliseconds = line.take('P').map(|p| 1e-3 * p);
        let duration = milliseconds
            .or_else(|| line.take('S'))
            .ok_or(GcodeError::Dwell)?;
        if !(0.0..=f64::from(LONGEST)).contains(&duration) {
            return Err(GcodeError::Dwell);
        }
        if duration > 0.0 {
            self.push(number, Action::Dwell { duration });
        }
        Ok(())
    }

    /// G28: the tool goes home in x and y, whichever of them is named, because the arm's
    /// joints cannot move along one axis alone.
    fn home(&mut self, number: u32, line: &mut Line) -> Result<(), GcodeError> {
        let (x, y) = (line.take('X'), line.take('Y'));
        if self.skip_height(number, line) && x.is_none() && y.is_none() {
            return Ok(());
        }
        let Placement {
            origin,
            scale,
            home,
        } = *self.placement;
        self.position = [0, 1].map(|axis| (home[axis] - origin[axis]) / scale);
        self.go(number, None)
    }

    /// G92: gives the tool's present position these coordinates.
    fn shift(&mut self, number: u32, line: &mut Line) -> Result<(), GcodeError> {
        self.skip_height(number, line);
        let named = ['X', 'Y'].map(|letter| line.take(letter));
        for axis in 0..2 {
            // Without coordinates, the present position becomes (0, 0).
            let value = match named {
                [None, None] => Some(0.0),
                _ => named[axis],
            };
            if let Some(value) = value {
                self.zero[axis] = self.position[axis] - within_reach(value * self.unit)?;
            }
        }
        Ok(())
    }

    fn motion(&mut self, number: u32, line: &mut Line) -> Result<(), GcodeError> {
        let start = self.position;
        let mut end = start;
        let mut moves = false;
        for (axis, letter) in ['X', 'Y'].into_iter().enumerate() {
            if let Some(value) = line.take(letter) {
                let value = value * self.unit;
                let from = if self.relative {
                    start[axis]
                } else {
                    self.zero[axis]
                };
                end[axis] = within_reach(from + value)?;
                moves = true;
            }
        }
        self.skip_height(number, line);
        let offset = ['I', 'J'].map(|letter| line.take(letter));
        let radius = line.take('R').map(|radius| radius * self.unit);
        let bends = offset.iter().any(Option::is_some) || radius.is_some();
        if !moves && !bends {
            return Ok(());
        }
        let motion = self.motion.ok_or(GcodeError::NoMode)?;
        if matches!(motion, MotionMode::Rapid | MotionMode::Line) {
            if bends {
                return Err(GcodeError::StrayWord(if radius.is_some() {
                    'R'
                } else {
                    'I'
                }));
            }
            let feed = match motion {
                MotionMode::Rapid => None,
                _ => Some(self.feed.ok_or(GcodeError::NoFeed)?),
            };
            self.position = end;
            return self.go(number, feed);
        }
        let feed = self.feed.ok_or(GcodeError::NoFeed)?;
        let clockwise = motion == MotionMode::Clockwise;
        let center = match (offset, radius) {
            ([None, None], Some(radius)) => arc::center_by_radius(start, end, radius, clockwise)?,
            ([None, None], None) | (_, Some(_)) => return Err(GcodeError::ArcForm),
            (offset, None) => {
                let offset = offset.map(|value| value.unwrap_or(0.0) * self.unit);
                arc::center_by_offset(start, end, offset)?
            }
        };
        // An arc starts at the job's position, even if no motion has brought the tool there.
        self.go(number, None)?;
        self.position = end;
        if arc::is_negligible(
            start,
            end,
            center,
            clockwise,
            MIN_LENGTH / self.placement.scale,
        ) {
            return Ok(());
        }
        let to = self.place(end)?;
        self.placed = Some(to);
        let center = self.place(center)?;
        self.push(
            number,
            Action::Arc {
                to,
                center,
                clockwise,
                feed,
            },
        );
        Ok(())
    }

    /// Adds a straight step to the job's position, unless the tool is there.
    fn go(&mut self, number: u32, feed: Option<f64>) -> Result<(), GcodeError> {
        let to = self.place(self.position)?;
        let length = self.placed.map_or(f64::INFINITY, |from| {
            (to[0] - from[0]).hypot(to[1] - from[1])
        });
        if length >= MIN_LENGTH {
            self.placed = Some(to);
            self.push(number, Action::Line { to, feed });
        }
        Ok(())
    }

    fn place(&self, point: [f64; 2]) -> Result<[f64; 2], GcodeError> {
        let Placement { origin, scale, .. } = *self.placement;
        let [x, y] = [0, 1].map(|axis| origin[axis] + scale * point[axis]);
        Ok([within_reach(x)?, within_reach(y)?])
    }

    fn push(&mut self, line: u32, action: Action) {
        let tool = self.tool;
        self.job.steps.push(Step { line, tool, action });
    }

    /// Takes Z from the line; returns whether there was one.
    fn skip_height(&mut self, number: u32, line: &mut Line) -> bool {
        let found = line.take('Z').is_some();
        if found && !self.height_warned {
            self.height_warned = true;
            self.warn(number, WarningKind::Height);
        }
        found
    }

    fn warn(&mut self, line: u32, kind: WarningKind) {
        self.job.warnings.push(Warning { line, kind });
    }
}

fn within_reach(coordinate: f64) -> Result<f64, GcodeError> {
    if coordinate.abs() <= MAX_COORDINATE {
        Ok(coordinate)
    } else {
        Err(GcodeError::TooFar(coordinate))
    }
}
