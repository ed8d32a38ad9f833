//! Motions: from the coordinates of a line to steps.

use super::arc::CircularArc;
use super::interpreter::Interpreter;
use super::modes::MotionMode;
use super::tool::{Activity, ToolState, is_down};
use super::words::Words;
use super::{Action, GcodeError, Step, ToolWords, WarningKind, arc};

/// Coordinates beyond this [m] are a mistake in the units.
const MAX_COORDINATE: f64 = 1e3;
/// Shorter motions [m] are dropped: their ends may be the same in `f32`.
pub(super) const MIN_LENGTH: f64 = 1e-7;

impl Interpreter {
    pub(super) fn motion(
        &mut self,
        number: u32,
        words: &mut Words,
        machine: bool,
        power: Option<f64>,
    ) -> Result<(), GcodeError> {
        let start = self.position;
        let z_start = self.tool.z;
        let mut end = start;
        let named = ['X', 'Y'].map(|letter| words.take(letter));
        let moves = named.iter().any(Option::is_some);
        for axis in 0..2 {
            let Some(value) = named[axis] else { continue };
            let from = if self.modes.relative {
                start[axis]
            } else {
                self.zero[axis]
            };
            end[axis] = within_reach(from + value * self.modes.unit)?;
        }
        if machine {
            self.job.depends_on_home |= moves;
            end = self.machine_point(start, named)?;
        }
        self.lift(number, words.take('Z'), machine)?;
        let extruder = words.take('E');
        self.tool.extrude(extruder, self.modes.relative);
        let offset = ['I', 'J'].map(|letter| words.take(letter));
        if let Some(k) = words.take('K')
            && k != 0.0
        {
            return Err(GcodeError::StrayWord('K'));
        }
        let radius = words.take('R').map(|radius| radius * self.modes.unit);
        let bends = offset.iter().any(Option::is_some) || radius.is_some();
        if !moves && !bends {
            return Ok(());
        }
        let motion = self.modes.motion.ok_or(GcodeError::NoMode)?;
        if motion == MotionMode::Rapid {
            if bends {
                return Err(stray(radius));
            }
            self.evidence.moves(number, &self.tool, true);
            return self.straight(number, z_start, end, None, Activity::Rapid);
        }
        self.evidence.moves(number, &self.tool, false);
        let feed = self.speed(number)?;
        self.evidence.feeds(self.tool.servo_angle, power.is_some());
        self.evidence.extrudes |= self.tool.extrudes;
        if motion == MotionMode::Line {
            if bends {
                return Err(stray(radius));
            }
            return self.straight(number, z_start, end, Some(feed), Activity::Feed);
        }
        let clockwise = motion == MotionMode::Clockwise;
        let arcs = self.arcs(start, end, offset, radius, clockwise)?;
        let down = |z: Option<f64>| z.is_some_and(|z| is_down(z, &self.rules));
        if self.rules.words == ToolWords::Height && down(z_start) != down(self.tool.z) {
            return Err(GcodeError::Helix);
        }
        // An arc starts at the job's position, even if no motion has brought the tool there.
        self.approach()?;
        self.position = end;
        let shortest = MIN_LENGTH / self.placement.scale;
        if let &[only] = &arcs[..]
            && arc::is_negligible(start, only, clockwise, shortest)
        {
            return Ok(());
        }
        let tool = self.tool.level(&self.rules, Activity::Feed);
        for CircularArc { to, center } in arcs {
            let to = self.place(to)?;
            self.placed = Some(to);
            let center = self.place(center)?;
            let action = Action::Arc {
                to,
                center,
                clockwise,
                feed,
            };
            self.push(number, tool, action)?;
        }
        Ok(())
    }

    /// The arcs of circles of an arc [m].
    fn arcs(
        &self,
        start: [f64; 2],
        end: [f64; 2],
        offset: [Option<f64>; 2],
        radius: Option<f64>,
        clockwise: bool,
    ) -> Result<Vec<CircularArc>, GcodeError> {
        let rounding = self.modes.arc_rounding();
        match (offset, radius) {
            ([None, None], Some(radius)) => Ok(vec![arc::by_radius(
                [start, end],
                radius,
                clockwise,
                rounding,
            )?]),
            ([None, None], None) | (_, Some(_)) => Err(GcodeError::ArcForm),
            (offset, None) => {
                let absolute = self.modes.absolute_centers;
                let offset = [0, 1].map(|axis| match offset[axis] {
                    Some(value) if absolute => {
                        self.zero[axis] + value * self.modes.unit - start[axis]
                    }
                    Some(value) => value * self.modes.unit,
                    // The coordinate that is left out is that of the start.
                    None => 0.0,
                });
                arc::by_offset([start, end], offset, clockwise, rounding)
            }
        }
    }

    /// A straight motion to `end` from Z `z_start`. Where Z passes the height at which the tool
    /// touches down, the motion is divided.
    fn straight(
        &mut self,
        number: u32,
        z_start: Option<f64>,
        end: [f64; 2],
        feed: Option<f64>,
        activity: Activity,
    ) -> Result<(), GcodeError> {
        let start = self.position;
        let z_end = self.tool.z;
        let at = |z: Option<f64>| {
            let tool = ToolState {
                z,
                ..self.tool.clone()
            };
            tool.level(&self.rules, activity)
        };
        let [first, second] = [z_start, z_end].map(at);
        let crossing = match (z_start, z_end) {
            (Some(from), Some(to)) if first != second => (self.rules.height - from) / (to - from),
            _ => 0.0,
        };
        if first > 0.0 || second > 0.0 {
            self.approach()?;
        }
        let crossing = crossing.clamp(0.0, 1.0);
        if crossing > 0.0 && crossing < 1.0 {
            self.position = [0, 1].map(|axis| start[axis] + crossing * (end[axis] - start[axis]));
            self.go(number, first, feed)?;
        }
        self.position = end;
        self.go(number, second, feed)
    }

    /// Takes the tool to the job's position before it draws, if no motion has brought it there: a
    /// job begins at its X0 Y0, also after G28. That motion belongs to no line.
    pub(super) fn approach(&mut self) -> Result<(), GcodeError> {
        match self.placed {
            Some(_) if !self.is_home => Ok(()),
            _ => self.go(0, 0.0, None),
        }
    }

    /// Takes the tool to the job's X0 Y0, if nothing has moved it.
    pub(super) fn begin(&mut self) -> Result<(), GcodeError> {
        match self.placed {
            Some(_) => Ok(()),
            None => self.approach(),
        }
    }

    /// Adds a straight step to the job's position, unless the tool is there.
    pub(super) fn go(
        &mut self,
        number: u32,
        tool: f64,
        feed: Option<f64>,
    ) -> Result<(), GcodeError> {
        self.is_home = false;
        let to = self.place(self.position)?;
        let length = self.placed.map_or(f64::INFINITY, |from| {
            (to[0] - from[0]).hypot(to[1] - from[1])
        });
        if length >= MIN_LENGTH {
            self.placed = Some(to);
            self.push(number, tool, Action::Line { to, feed })?;
        }
        Ok(())
    }

    /// Moves Z [file's units].
    fn lift(&mut self, number: u32, value: Option<f64>, machine: bool) -> Result<(), GcodeError> {
        let Some(value) = value else { return Ok(()) };
        if machine {
            // The machine's Z is counted down from its top, where the tool is up.
            self.tool.z = None;
            return Ok(());
        }
        let value = value * self.modes.unit;
        let z = if self.modes.relative {
            self.tool.z.unwrap_or(0.0) + value
        } else {
            value
        };
        self.set_z(number, within_reach(z)?);
        Ok(())
    }

    pub(super) fn set_z(&mut self, number: u32, z: f64) {
        self.tool.z = Some(z);
        self.evidence.height(number, z);
        if self.rules.words != ToolWords::Height {
            self.job.note(number, WarningKind::Height);
        }
    }

    /// The point in the job's frame with these coordinates of the machine, whose zero is home [m].
    fn machine_point(
        &self,
        start: [f64; 2],
        named: [Option<f64>; 2],
    ) -> Result<[f64; 2], GcodeError> {
        let mut point = self.place(start)?;
        for axis in 0..2 {
            if let Some(value) = named[axis] {
                point[axis] = self.placement.home[axis] + value * self.modes.unit;
            }
        }
        Ok(self.placement.unplace(point))
    }

    pub(super) fn place(&self, point: [f64; 2]) -> Result<[f64; 2], GcodeError> {
        let [x, y] = self.placement.place(point);
        Ok([within_reach(x)?, within_reach(y)?])
    }

    pub(super) fn push(&mut self, line: u32, tool: f64, action: Action) -> Result<(), GcodeError> {
        self.budget.take(1)?;
        self.job.steps.push(Step { line, tool, action });
        Ok(())
    }
}

fn stray(radius: Option<f64>) -> GcodeError {
    GcodeError::StrayWord(if radius.is_some() { 'R' } else { 'I' })
}

/// The coordinate [m], unless it is a mistake in the units.
pub(super) fn within_reach(coordinate: f64) -> Result<f64, GcodeError> {
    if coordinate.abs() <= MAX_COORDINATE {
        Ok(coordinate)
    } else {
        Err(GcodeError::TooFar(coordinate))
    }
}
