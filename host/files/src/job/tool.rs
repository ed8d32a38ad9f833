//! The tool of a job: which words move or switch it, and its level.

use super::options::Dialect;
use serde::{Deserialize, Serialize};

/// M300 S up to this puts the pen down, above it lifts it (S255 turns its servo off).
const PEN_DOWN_ANGLE: f64 = 40.0;
/// S of M106 at full power.
const FULL_FAN: f64 = 255.0;
/// Rounding in Z [m] and in E [file's units], which is no motion.
const ROUNDING: f64 = 1e-9;

/// The words of a job that move or switch the tool. A job has one kind of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum ToolWords {
    /// M3, M4 and M5 with S: a laser, a spindle, or a pen on their output.
    Spindle,
    /// M300 S: a pen on a servo, down up to S40.
    PenServo,
    /// M280 S: a pen on a servo; the angle that most G1 to G3 move with is down.
    Servo,
    /// M106 S and M107.
    Fan,
    /// Z: down at or below a height.
    Height,
    /// E: a motion that extrudes draws.
    Extruder,
    /// None: down on G1 to G3, up on G0.
    Motion,
}

/// How the words of a job are read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    pub(super) dialect: Dialect,
    pub(super) words: ToolWords,
    /// Greatest Z at which the tool is down [m].
    pub(super) height: f64,
    /// S of M280 with the pen down.
    pub(super) servo_down: f64,
    /// Whether the tool is a laser, which is off during G0 whatever M3 says.
    pub(super) is_laser: bool,
    /// The level by S of M3 and M4.
    pub(super) speed: SpeedRule,
}

/// The level that S of M3 and M4 gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SpeedRule {
    /// S as a share of this one.
    Share(f64),
    /// Down at any S above 0.
    AboveZero,
    /// Down at the S that is nearer to `down` than to `up`.
    Nearer { down: f64, up: f64 },
}

impl SpeedRule {
    fn level(self, speed: Option<f64>) -> f64 {
        let Some(speed) = speed else { return 1.0 };
        let is_down = match self {
            Self::Share(full) => return (speed / full).clamp(0.0, 1.0),
            Self::AboveZero => speed > 0.0,
            Self::Nearer { down, up } => (speed - down).abs() < (speed - up).abs(),
        };
        f64::from(u8::from(is_down))
    }

    /// Whether the tool has only two states.
    fn has_two_states(self) -> bool {
        !matches!(self, Self::Share(_))
    }
}

/// What a line does while the tool's level is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Activity {
    /// A motion by G0.
    Rapid,
    /// A motion by G1, G2 or G3.
    Feed,
    /// A dwell before any motion or after G0.
    RestAfterRapid,
    /// A dwell after G1, G2 or G3.
    RestAfterFeed,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spindle {
    Off,
    /// M3.
    Constant,
    /// M4: a laser's power follows its speed, and G0 is without power.
    Dynamic,
}

/// What the words so far have set.
#[derive(Clone, Debug)]
pub(super) struct ToolState {
    pub(super) spindle: Spindle,
    /// The last S of a spindle or a laser.
    pub(super) speed: Option<f64>,
    /// The last S of M300.
    pub(super) pen_angle: Option<f64>,
    /// The last S of M280.
    pub(super) servo_angle: Option<f64>,
    /// The level by M106 and M107.
    pub(super) fan: f64,
    /// Z [m]; none before the first Z and after homing, where the tool is up.
    pub(super) z: Option<f64>,
    /// Whether the present motion extrudes.
    pub(super) extrudes: bool,
    pub(super) e: f64,
    /// By M82 or M83; none: as G90 and G91 say.
    pub(super) e_relative: Option<bool>,
}

impl ToolState {
    pub(super) fn new() -> Self {
        Self {
            spindle: Spindle::Off,
            speed: None,
            pen_angle: None,
            servo_angle: None,
            fan: 0.0,
            z: None,
            extrudes: false,
            e: 0.0,
            e_relative: None,
        }
    }

    /// Applies an M code with its S. False if it is none of the tool's.
    pub(super) fn apply(&mut self, number: u32, value: Option<f64>) -> bool {
        match (number, value) {
            (3, _) => self.spindle = Spindle::Constant,
            (4, _) => self.spindle = Spindle::Dynamic,
            (5, _) => self.spindle = Spindle::Off,
            (300, Some(angle)) => self.pen_angle = Some(angle),
            (280, Some(angle)) => self.servo_angle = Some(angle),
            (106, _) => self.fan = (value.unwrap_or(FULL_FAN) / FULL_FAN).clamp(0.0, 1.0),
            (107, _) => self.fan = 0.0,
            (82, _) => self.e_relative = Some(false),
            (83, _) => self.e_relative = Some(true),
            _ => return false,
        }
        if let (3 | 4, Some(speed)) = (number, value) {
            self.speed = Some(speed);
        }
        true
    }

    /// Moves E; `relative` is the mode of the coordinates.
    pub(super) fn extrude(&mut self, value: Option<f64>, relative: bool) {
        let Some(value) = value else {
            self.extrudes = false;
            return;
        };
        let end = if self.e_relative.unwrap_or(relative) {
            self.e + value
        } else {
            value
        };
        self.extrudes = end > self.e + ROUNDING;
        self.e = end;
    }

    /// G92 E.
    pub(super) fn set_e(&mut self, value: f64) {
        self.e = value;
    }

    /// The level, 0…1.
    pub(super) fn level(&self, rules: &Rules, activity: Activity) -> f64 {
        let is_feed = matches!(activity, Activity::Feed | Activity::RestAfterFeed);
        let on = |is_on: bool| f64::from(u8::from(is_on));
        match rules.words {
            ToolWords::Spindle => {
                let is_on = match self.spindle {
                    Spindle::Off => false,
                    Spindle::Constant => is_feed || !rules.is_laser,
                    Spindle::Dynamic => activity == Activity::Feed,
                };
                on(is_on) * rules.speed.level(self.speed)
            }
            ToolWords::PenServo => on(self.pen_angle.is_some_and(|angle| angle <= PEN_DOWN_ANGLE)),
            ToolWords::Servo => on(self.servo_angle == Some(rules.servo_down)),
            ToolWords::Fan if rules.speed.has_two_states() => on(self.fan > 0.0),
            ToolWords::Fan => self.fan,
            ToolWords::Height => on(self.z.is_some_and(|z| is_down(z, rules))),
            ToolWords::Extruder => on(self.extrudes && activity == Activity::Feed),
            ToolWords::Motion => on(is_feed),
        }
    }
}

/// Whether the tool is down at this Z [m].
pub(super) fn is_down(z: f64, rules: &Rules) -> bool {
    z <= rules.height + ROUNDING
}
