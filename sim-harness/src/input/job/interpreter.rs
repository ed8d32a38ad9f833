//! What the lines mean: the modes that last from line to line, and the steps they make.

use super::error::quoted;
use super::words::{Code, Line, spelled};
use super::{Action, Job, JobError, Placement, Reason, Step, Warning, WarningKind, arc};
use fivebar_firmware::planner::LONGEST;

/// Coordinates beyond this [m] are a mistake in the units.
const FARTHEST: f64 = 1e3;
/// Motions shorter than this [m] are none: `f32` metres cannot tell their ends apart.
const SHORTEST: f64 = 1e-7;
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

/// The motions, which last until another is asked for.
#[derive(Clone, Copy, PartialEq)]
enum Motion {
    Rapid,
    Line,
    Clockwise,
    CounterClockwise,
}

/// What a line does with its coordinates.
#[derive(Clone, Copy, PartialEq)]
enum Use {
    Motion(Motion),
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
    motion: Option<Motion>,
    /// Speed [m/s].
    feed: Option<f64>,
    pen_down: bool,
    /// Where the tool is in the job [m], before placement.
    position: [f64; 2],
    /// The point at which X0 Y0 lies in the job [m], moved by G92.
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
            pen_down: false,
            position: [0.0; 2],
            zero: [0.0; 2],
            placed: None,
            height_warned: false,
        }
    }

    /// Does one line; true where it ends the job. As in every dialect, what stands on the
    /// line takes effect in a set order: feed and pen, modes, then the motion.
    fn line(&mut self, number: u32, text: &str) -> Result<bool, Reason> {
        let mut line = Line::read(text)?;
        let mut ends = false;
        for &(code, speed) in &line.miscellaneous {
            match code {
                ('M', 2 | 30, 0) => ends = true,
                ('M', 3 | 4, 0) => self.pen_down = true,
                ('M', 5, 0) => self.pen_down = false,
                ('M', 300, 0) if speed.is_some() => {
                    self.pen_down = speed.is_some_and(|angle| angle <= PEN_DOWN_ANGLE);
                }
                unknown => self.warn(number, WarningKind::UnknownCode(spelled(unknown))),
            }
        }
        let wanted = self.modes(&line.general)?;
        if let Some(feed) = line.take('F') {
            if feed <= 0.0 {
                return Err(Reason::Feed);
            }
            self.feed = Some(feed * self.unit / 60.0);
        }
        match wanted {
            Some(Use::Dwell) => self.dwell(number, &mut line)?,
            Some(Use::Home) => self.home(number, &mut line)?,
            Some(Use::Shift) => self.shift(number, &mut line)?,
            Some(Use::Motion(_)) | None => self.motion(number, &mut line)?,
        }
        // The speed of a spindle that a pen does not have.
        line.take('S');
        match line.left_over() {
            Some(letter) => Err(Reason::StrayWord(letter)),
            None => Ok(ends),
        }
    }

    /// Sets the modes and finds what the coordinates of the line are for.
    fn modes(&mut self, codes: &[Code]) -> Result<Option<Use>, Reason> {
        let mut wanted: Option<(Use, Code)> = None;
        for &code in codes {
            let asks = match code {
                ('G', 0, 0) => Use::Motion(Motion::Rapid),
                ('G', 1, 0) => Use::Motion(Motion::Line),
                ('G', 2, 0) => Use::Motion(Motion::Clockwise),
                ('G', 3, 0) => Use::Motion(Motion::CounterClockwise),
                ('G', 4, 0) => Use::Dwell,
                ('G', 28, 0) => Use::Home,
                ('G', 92, 0) => Use::Shift,
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
                unknown => return Err(Reason::UnknownGCode(spelled(unknown))),
            };
            if let Some((_, other)) = wanted {
                return Err(Reason::Conflict(spelled(other), spelled(code)));
            }
            wanted = Some((asks, code));
        }
        if let Some((Use::Motion(motion), _)) = wanted {
            self.motion = Some(motion);
        }
        Ok(wanted.map(|(asks, _)| asks))
    }

    fn dwell(&mut self, number: u32, line: &mut Line) -> Result<(), Reason> {
        let milliseconds = line.take('P').map(|p| 1e-3 * p);
        let duration = milliseconds
            .or_else(|| line.take('S'))
            .ok_or(Reason::Dwell)?;
        if !(0.0..=f64::from(LONGEST)).contains(&duration) {
            return Err(Reason::Dwell);
        }
        if duration > 0.0 {
            self.push(number, Action::Dwell { duration });
        }
        Ok(())
    }

    /// G28: both arms go home whatever axes are named, since they cannot go one by one.
    fn home(&mut self, number: u32, line: &mut Line) -> Result<(), Reason> {
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

    /// G92: from here on, the tool stands at these coordinates.
    fn shift(&mut self, number: u32, line: &mut Line) -> Result<(), Reason> {
        self.skip_height(number, line);
        let named = ['X', 'Y'].map(|letter| line.take(letter));
        for axis in 0..2 {
            // Without coordinates, here is (0, 0).
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

    fn motion(&mut self, number: u32, line: &mut Line) -> Result<(), Reason> {
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
        let motion = self.motion.ok_or(Reason::NoMode)?;
        if matches!(motion, Motion::Rapid | Motion::Line) {
            if bends {
                return Err(Reason::StrayWord(if radius.is_some() { 'R' } else { 'I' }));
            }
            let feed = match motion {
                Motion::Rapid => None,
                _ => Some(self.feed.ok_or(Reason::NoFeed)?),
            };
            self.position = end;
            return self.go(number, feed);
        }
        let feed = self.feed.ok_or(Reason::NoFeed)?;
        let clockwise = motion == Motion::Clockwise;
        let center = match (offset, radius) {
            ([None, None], Some(radius)) => arc::center_by_radius(start, end, radius, clockwise)?,
            ([None, None], None) | (_, Some(_)) => return Err(Reason::ArcForm),
            (offset, None) => {
                let offset = offset.map(|value| value.unwrap_or(0.0) * self.unit);
                arc::center_by_offset(start, end, offset)?
            }
        };
        // An arc starts where the job says the tool is, even if nothing has moved it there.
        self.go(number, None)?;
        self.position = end;
        if arc::is_a_speck(
            start,
            end,
            center,
            clockwise,
            SHORTEST / self.placement.scale,
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

    /// A straight step to where the job now is, unless the tool stands there.
    fn go(&mut self, number: u32, feed: Option<f64>) -> Result<(), Reason> {
        let to = self.place(self.position)?;
        let length = self.placed.map_or(f64::INFINITY, |from| {
            (to[0] - from[0]).hypot(to[1] - from[1])
        });
        if length >= SHORTEST {
            self.placed = Some(to);
            self.push(number, Action::Line { to, feed });
        }
        Ok(())
    }

    fn place(&self, point: [f64; 2]) -> Result<[f64; 2], Reason> {
        let Placement { origin, scale, .. } = *self.placement;
        let [x, y] = [0, 1].map(|axis| origin[axis] + scale * point[axis]);
        Ok([within_reach(x)?, within_reach(y)?])
    }

    fn push(&mut self, line: u32, action: Action) {
        let pen_down = self.pen_down;
        self.job.steps.push(Step {
            line,
            pen_down,
            action,
        });
    }

    /// Takes Z off the line; true where there was one.
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

fn within_reach(coordinate: f64) -> Result<f64, Reason> {
    if coordinate.abs() <= FARTHEST {
        Ok(coordinate)
    } else {
        Err(Reason::TooFar(coordinate))
    }
}
