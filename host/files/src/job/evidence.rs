//! What a job's words show of the program that wrote it, and the rules that follow from it.

use super::options::{Dialect, JobOptions, ToolLevels};
use super::pen_speeds::PenSpeeds;
use super::tool::{Rules, SpeedRule, ToolState};
use super::words::{Line, spelled};
use super::{ToolWords, Warning, WarningKind};

/// Heights closer than this are the same [m].
const LEAST_LIFT: f64 = 1e-6;

/// Most angles of a servo among which that of the pen down is looked for: a pen has two.
const MOST_ANGLES: usize = 100;

/// What was seen while the job was read for the first time.
#[derive(Clone, Debug)]
pub(super) struct Evidence {
    /// The first sign of RepRap, with its line.
    reprap: Option<(u32, String)>,
    /// The first line with G4 P.
    pub(super) dwell: Option<u32>,
    pen_servo: bool,
    /// The angles of M280, each with the number of G1 to G3 at it.
    servo: Vec<(f64, u32)>,
    spindle: bool,
    /// The motions at each S of M3 and M4.
    speeds: PenSpeeds,
    fan: bool,
    /// S on a motion, as lasers have it.
    power_on_motion: bool,
    /// E that advances along a motion.
    pub(super) extrudes: bool,
    /// Least and greatest Z [m].
    heights: Option<[f64; 2]>,
    /// The first line with Z.
    height_line: u32,
}

impl Evidence {
    pub(super) fn new() -> Self {
        Self {
            reprap: None,
            dwell: None,
            pen_servo: false,
            servo: Vec::new(),
            spindle: false,
            speeds: PenSpeeds::default(),
            fan: false,
            power_on_motion: false,
            extrudes: false,
            heights: None,
            height_line: 0,
        }
    }

    /// Notes the codes of a line.
    pub(super) fn codes(&mut self, number: u32, line: &Line) {
        let mut sign = None;
        for &(code, value) in &line.miscellaneous {
            match code {
                ('M', 3 | 4, 0) => self.spindle = true,
                ('M', 300, 0) if value.is_some() => self.pen_servo = true,
                ('M', 106, 0) => self.fan = true,
                ('M', 280, 0) => self.servo_angle(value, 0),
                _ => {}
            }
            if let ('M', 17 | 18 | 80.., _) = code {
                sign = sign.or_else(|| Some(spelled(code)));
            }
        }
        if line.has('E') {
            sign = sign.or_else(|| Some("E".into()));
        }
        if line.has_checksum {
            sign = sign.or_else(|| Some("the checksum".into()));
        }
        if let (None, Some(sign)) = (&self.reprap, sign) {
            self.reprap = Some((number, sign));
        }
    }

    /// Notes a motion by G1 to G3 with the servo at this angle.
    pub(super) fn feeds(&mut self, servo_angle: Option<f64>, has_power: bool) {
        self.power_on_motion |= has_power;
        self.servo_angle(servo_angle, 1);
    }

    /// Notes a motion with the tool in this state.
    pub(super) fn moves(&mut self, line: u32, tool: &ToolState, is_rapid: bool) {
        self.speeds.moves(line, tool, is_rapid);
    }

    fn servo_angle(&mut self, angle: Option<f64>, motions: u32) {
        let Some(angle) = angle else { return };
        let is_room = self.servo.len() < MOST_ANGLES;
        match self.servo.iter_mut().find(|(other, _)| *other == angle) {
            Some((_, count)) => *count += motions,
            None if is_room => self.servo.push((angle, motions)),
            None => {}
        }
    }

    /// Notes a Z [m].
    pub(super) fn height(&mut self, line: u32, z: f64) {
        let [low, high] = self.heights.unwrap_or([z; 2]);
        self.heights = Some([low.min(z), high.max(z)]);
        if self.height_line == 0 {
            self.height_line = line;
        }
    }

    fn lifts(&self) -> Option<[f64; 2]> {
        self.heights.filter(|[low, high]| high - low > LEAST_LIFT)
    }

    /// The rules of the job, and notes on those that were guessed.
    pub(super) fn rules(&self, options: &JobOptions) -> (Rules, Vec<Warning>) {
        let mut notes = Vec::new();
        let found = match &self.reprap {
            Some(_) => Dialect::RepRap,
            None => Dialect::Grbl,
        };
        let dialect = options.dialect.unwrap_or(found);
        if let (Some(line), None) = (self.dwell, options.dialect) {
            let kind = WarningKind::DwellUnit(dialect, self.reprap.clone());
            notes.push(Warning::at(line, kind));
        }
        let words = options.tool.unwrap_or_else(|| self.words(options));
        let mut height = options.pen_height.unwrap_or(0.0);
        if let (ToolWords::Height, None, Some([low, high])) =
            (words, options.pen_height, self.lifts())
            && !(low <= 0.0 && 0.0 < high)
        {
            height = 0.5 * (low + high);
            let kind = WarningKind::PenHeight(height);
            notes.push(Warning::at(self.height_line, kind));
        }
        if words == ToolWords::Motion && options.tool.is_none() {
            notes.push(Warning::at(0, WarningKind::NoToolWords));
        }
        let (speed, note) = match options.levels {
            ToolLevels::Shares => (SpeedRule::Share(options.full_power), None),
            ToolLevels::TwoStates(Some([down, up])) => (SpeedRule::Nearer { down, up }, None),
            ToolLevels::TwoStates(None) if self.power_on_motion => self.speeds.above_zero(),
            ToolLevels::TwoStates(None) => self.speeds.rule(),
        };
        notes.extend(note.filter(|_| words == ToolWords::Spindle));
        let most = self.servo.iter().max_by_key(|(_, count)| *count);
        let rules = Rules {
            dialect,
            words,
            height,
            servo_down: most.map_or(0.0, |(angle, _)| *angle),
            is_laser: self.power_on_motion,
            speed,
        };
        (rules, notes)
    }

    fn words(&self, options: &JobOptions) -> ToolWords {
        let kinds = [
            (options.pen_height.is_some(), ToolWords::Height),
            (self.pen_servo, ToolWords::PenServo),
            (self.servo.len() > 1, ToolWords::Servo),
            (self.extrudes, ToolWords::Extruder),
            (self.spindle && self.power_on_motion, ToolWords::Spindle),
            (self.lifts().is_some(), ToolWords::Height),
            (self.spindle, ToolWords::Spindle),
            (self.fan, ToolWords::Fan),
        ];
        let first = kinds.into_iter().find(|(is_found, _)| *is_found);
        first.map_or(ToolWords::Motion, |(_, words)| words)
    }
}

/// The rules of the first reading, in which the levels do not matter. Milliseconds, so that no
/// dwell is too long.
pub(super) const UNDECIDED: Rules = Rules {
    dialect: Dialect::RepRap,
    words: ToolWords::Motion,
    height: f64::NEG_INFINITY,
    servo_down: 0.0,
    is_laser: false,
    speed: SpeedRule::Share(1.0),
};
