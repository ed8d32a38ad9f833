//! Motions that a hand has taught: their record, smoothed, in a file, and replayed as timed moves.

mod record;
mod replay;
mod rests;

pub use record::{Record, TeachError};
pub use replay::{LEAST_SPEED, MOST_SPEED, ReplayError};
pub use rests::SHORTEST_REST;

use serde::{Deserialize, Serialize};

/// A taught motion of the tip, from rest to rest, as its file has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaughtPath {
    /// What the file is.
    #[serde(rename = "taught_path")]
    version: u32,
    /// The name of the robot that it was taught to.
    pub robot: String,
    /// Time between two knots [s].
    pub knot_s: f64,
    /// The tip at the knots [m].
    pub tip_m: Vec<[f64; 2]>,
}

/// The version of the file.
const VERSION: u32 = 1;
/// The least number of knots.
const LEAST_KNOTS: usize = 5;
/// The times between two knots that a file may have [s].
const KNOT_TIMES: [f64; 2] = [1e-3, 0.1];
/// The longest motion [s].
pub const LONGEST: f64 = 600.0;

/// Why a file is no taught path.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TaughtPathError {
    /// It is no JSON of this shape.
    #[error("it is no taught path: {0}; `fivebar teach --out FILE` writes one")]
    Json(#[from] serde_json::Error),
    /// It is of another version.
    #[error("`taught_path` is {0}, and this program reads {VERSION}: teach it again")]
    Version(u32),
    /// The time between knots.
    #[error("`knot_s` is {0}; it must be from 0.001 to 0.1 s")]
    KnotTime(f64),
    /// Too few knots, or too many.
    #[error("`tip_m` has {0} points; it must have 5 or more, and last 600 s at most")]
    Count(usize),
    /// A point is not finite.
    #[error("point {0} of `tip_m` is not finite")]
    Point(usize),
}

impl TaughtPath {
    /// The path in a file's text.
    ///
    /// # Errors
    /// What of it is not valid.
    pub fn parse(text: &str) -> Result<Self, TaughtPathError> {
        let path: Self = serde_json::from_str(text)?;
        let [shortest, longest] = KNOT_TIMES;
        if path.version != VERSION {
            return Err(TaughtPathError::Version(path.version));
        }
        if !(shortest <= path.knot_s && path.knot_s <= longest) {
            return Err(TaughtPathError::KnotTime(path.knot_s));
        }
        if path.tip_m.len() < LEAST_KNOTS || path.time() > LONGEST {
            return Err(TaughtPathError::Count(path.tip_m.len()));
        }
        let wrong = (path.tip_m.iter()).position(|point| !point.iter().all(|x| x.is_finite()));
        match wrong {
            Some(index) => Err(TaughtPathError::Point(index)),
            None => Ok(path),
        }
    }

    /// The file's text.
    pub fn to_json(&self) -> String {
        let points: Vec<String> = (self.tip_m.iter())
            .map(|[x, y]| format!("    [{x:.7}, {y:.7}]"))
            .collect();
        let name = serde_json::Value::from(self.robot.as_str());
        format!(
            "{{\n  \"taught_path\": {VERSION},\n  \"robot\": {name},\n  \"knot_s\": {},\n  \"tip_m\": [\n{}\n  ]\n}}\n",
            self.knot_s,
            points.join(",\n")
        )
    }

    /// How long it lasts [s].
    pub fn time(&self) -> f64 {
        self.knot_s * self.tip_m.len().saturating_sub(1) as f64
    }

    /// Its length [m].
    pub fn length(&self) -> f64 {
        let steps = self.tip_m.windows(2);
        steps
            .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]))
            .sum()
    }
}

#[cfg(test)]
mod tests;
