//! What a job's text leaves open.

use super::{ToolWords, Trace};
use serde::{Deserialize, Serialize};

/// The unit of G4 P, on which programs do not agree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Dialect {
    /// Seconds, as Grbl, LinuxCNC, Fusion, FreeCAD and LightBurn write it.
    Grbl,
    /// Milliseconds, as RepRap firmwares such as Marlin have it.
    RepRap,
}

/// The levels that the arm's tool has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum ToolLevels {
    /// Every share from off to full power: a laser, a spindle.
    #[default]
    Shares,
    /// Down or up, on or off: a pen on a servo, a switch. With S of M3 and M4 for down and for up,
    /// if the robot file states them; else any S above 0 is down.
    TwoStates(Option<[f64; 2]>),
}

/// How a job is read where its text leaves it open.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct JobOptions {
    /// The dialect; none: RepRap if the job has one of its signs (M17, M18, M80 or above, an E word,
    /// a checksum), or else Grbl.
    pub dialect: Option<Dialect>,
    /// The words that move or switch the tool; none: the first kind that the job has, in the order
    /// M300, M280, E, S on a motion, Z to both sides of `pen_height`, M3 or M4, M106.
    pub tool: Option<ToolWords>,
    /// Z at or below which the tool is down [m]; none: 0, or the middle between the least and the
    /// greatest Z if 0 does not separate them.
    pub pen_height: Option<f64>,
    /// S of M3 and M4 at full power, as $30 of Grbl.
    pub full_power: f64,
    /// The levels of the arm's tool.
    pub levels: ToolLevels,
    /// Greatest distance of the lines of an SVG from its curves [m].
    pub tolerance: f64,
    /// Speed along what is drawn [m/s], in place of F; none: F, or the arm's greatest speed along strokes of drawings.
    pub speed: Option<f64>,
    /// Speed of G1, G2 and G3 before any F [m/s]; none: such a line is refused.
    pub speed_without_feed: Option<f64>,
    /// Distance of the lines that fill the areas of an SVG, and that make a picture black [m]; none: areas have outlines only,
    /// and a picture is black with lines 0.5 mm apart.
    pub hatch: Option<f64>,
    /// How a picture becomes strokes; none: by its outlines, which is noted.
    pub trace: Option<Trace>,
    /// The darkness of a picture that becomes ink, or half as much ink as black, above 0 and below 1; none: for outlines and
    /// lines the one that divides the picture best, for tones 0.5.
    pub level: Option<f64>,
    /// How often a drawing is drawn, in columns and rows.
    pub copies: [u32; 2],
    /// The distance between the boxes around two copies [m].
    pub gap: f64,
}

impl JobOptions {
    /// Whether a number is a level of darkness.
    pub fn is_level(level: f64) -> bool {
        level > 0.0 && level < 1.0
    }

    /// Whether these are columns and rows of copies: 1 to 100 each.
    pub fn are_copies(copies: [u32; 2]) -> bool {
        copies.iter().all(|it| (1..=100).contains(it))
    }
}

impl Default for JobOptions {
    fn default() -> Self {
        Self {
            dialect: None,
            tool: None,
            pen_height: None,
            full_power: 1000.0,
            levels: ToolLevels::Shares,
            tolerance: 2.5e-5,
            speed: None,
            speed_without_feed: None,
            hatch: None,
            trace: None,
            level: None,
            copies: [1, 1],
            gap: 5e-3,
        }
    }
}
