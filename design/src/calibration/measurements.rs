//! What can be measured: touches of a plate with known holes, distances, unknown holes, photographs.

use super::error::CalibrationError;
use crate::fit::Loss;
use fivebar_kinematics::five_bar::{Joint, Side};
use nalgebra::Vector2;

/// The tip in a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The encoder angles of joints 1 and 4, each up to whole turns [rad].
    pub encoder: [f64; 2],
    /// The hole on the plate [m].
    pub hole: Vector2<f64>,
}

/// What a calibration makes least.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Criterion {
    /// The sum of squares of all residuals.
    LeastSquares,
    /// Huber's loss with the threshold 1.5 σ; measurements beyond 4 σ are left out at the end.
    Huber,
}

impl Criterion {
    /// The loss of residuals with this standard deviation.
    pub(super) fn loss(self, sigma: f64) -> Loss {
        match self {
            Self::LeastSquares => Loss::Squares,
            Self::Huber => Loss::Huber(1.5 * sigma),
        }
    }
}

/// What is known for a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    /// The measurements.
    pub touches: Vec<Touch>,
    /// The assembly mode in which they were made.
    pub assembly: Side,
    /// The standard deviation of a hole's x and of its y [m].
    pub sigma: f64,
    /// What is made least; each coordinate is a residual of its own.
    pub criterion: Criterion,
}

/// Two poses of the tip whose distance is known: the balls of a ball-bar, or two drawn points
/// between which a calliper was put.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// The encoder angles of joints 1 and 4 in both poses, each up to whole turns [rad].
    pub encoders: [[f64; 2]; 2],
    /// Their distance [m].
    pub length: f64,
}

/// The tip in a hole whose position is not known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoleTouch {
    /// The hole: touches with the same number are of one hole.
    pub hole: i64,
    /// The encoder angles of joints 1 and 4, each up to whole turns [rad].
    pub encoder: [f64; 2],
}

/// A point that the tip drew, in a photograph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotoPoint {
    /// The encoder angles of joints 1 and 4, each up to whole turns [rad].
    pub encoder: [f64; 2],
    /// Its position in the photograph, in pixels of any frame.
    pub pixel: Vector2<f64>,
}

/// Standard deviations of what is measured [m]; for photographs in the drawing's plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviations {
    /// Of a known hole's x and of its y.
    pub plate: f64,
    /// Of a bar's length.
    pub bar: f64,
    /// Of the tip in an unknown hole, along x and along y.
    pub hole: f64,
    /// Of a photographed point's x and of its y.
    pub photo: f64,
}

/// Measurements of one arm, of any kinds.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurements {
    /// Touches of a plate with known holes: none, or at least three.
    pub plate: Vec<Touch>,
    /// Known distances.
    pub bars: Vec<Bar>,
    /// Touches of holes at unknown positions.
    pub holes: Vec<HoleTouch>,
    /// Photographs, each from a camera position of its own, of five points or more.
    pub photos: Vec<Vec<PhotoPoint>>,
    /// The assembly mode in which all was measured.
    pub assembly: Side,
    /// How well it was measured.
    pub deviations: Deviations,
    /// What is made least; each coordinate and each distance is a residual of its own.
    pub criterion: Criterion,
}

impl Measurements {
    /// The numbers of the holes, each once.
    pub(super) fn hole_numbers(&self) -> Vec<i64> {
        let mut numbers: Vec<i64> = self.holes.iter().map(|touch| touch.hole).collect();
        numbers.sort_unstable();
        numbers.dedup();
        numbers
    }

    pub(super) fn check(&self) -> Result<(), CalibrationError> {
        let Deviations {
            plate,
            bar,
            hole,
            photo,
        } = self.deviations;
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let angles = self.plate.iter().map(|touch| touch.encoder);
        let angles = angles.chain(self.bars.iter().flat_map(|bar| bar.encoders));
        let angles = angles.chain(self.holes.iter().map(|touch| touch.encoder));
        let points = || self.photos.iter().flatten();
        let mut angles = angles.chain(points().map(|point| point.encoder)).flatten();
        let positions = self.plate.iter().map(|touch| touch.hole);
        let mut positions = positions.chain(points().map(|point| point.pixel));
        let finite = [plate, bar, hole, photo].into_iter().all(positive)
            && angles.all(f64::is_finite)
            && positions.all(|position| position.iter().all(|value| value.is_finite()));
        if !finite {
            return Err(CalibrationError::NotFinite);
        }
        if let Some(index) = self.bars.iter().position(|bar| !positive(bar.length)) {
            return Err(CalibrationError::BarLength(index));
        }
        let poses = |number: i64| {
            let touches = self.holes.iter().filter(move |touch| touch.hole == number);
            different(touches.map(|touch| touch.encoder))
        };
        if let Some(hole) = self.hole_numbers().into_iter().find(|n| poses(*n) < 2) {
            return Err(CalibrationError::LoneTouch(hole));
        }
        for (index, photo) in self.photos.iter().enumerate() {
            let poses = different(photo.iter().map(|point| point.encoder));
            if poses < 5 {
                return Err(CalibrationError::SmallPhoto(index, poses));
            }
        }
        match self.plate.len() {
            1 | 2 => Err(CalibrationError::SmallPlate(self.plate.len())),
            _ => Ok(()),
        }
    }
}

/// How many of these poses are different, by more than two milliradians of one joint.
pub(super) fn different(encoders: impl Iterator<Item = [f64; 2]>) -> usize {
    let mut found: Vec<[f64; 2]> = Vec::new();
    for pose in encoders {
        let same = |other: &[f64; 2], joint: Joint| {
            (0.5 * (pose[joint] - other[joint])).sin().abs() < 1e-3
        };
        let is_found = |other| Joint::ALL.into_iter().all(|joint| same(other, joint));
        if !found.iter().any(is_found) {
            found.push(pose);
        }
    }
    found.len()
}
