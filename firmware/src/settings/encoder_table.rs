//! The known error of an encoder, as a table over one turn of its shaft.

use super::AxisField;
use fivebar_kinematics::Scalar;
use serde::{Deserialize, Serialize};

/// Points in a turn of the encoder's shaft.
pub const ENCODER_POINTS: usize = 64;

/// Angle of the encoder's shaft per unit of a point [rad].
pub const ENCODER_UNIT: f32 = 1.0 / 32_768.0;

/// The greatest difference of neighbouring points: a third of their distance, so that the angle
/// that belongs to a measured one is found quickly.
const STEEPEST: i32 = 1072;

/// An encoder's known error, to be corrected.
///
/// ```
/// use fivebar_firmware::settings::{ENCODER_UNIT, EncoderTable};
///
/// // A disc that is 0.01 rad off centre, behind a gear of 10.
/// let table = EncoderTable::new(10.0, |measured| 0.01 * measured.sin());
/// let quarter = f32::from(table.points[1][0]) * ENCODER_UNIT; // rad
/// assert!((quarter - 0.01).abs() < ENCODER_UNIT);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EncoderTable {
    /// Turns of the encoder's shaft per turn of the joint; 0 without a known error.
    pub shaft_ratio: f32,
    /// Measured angle less true angle of the shaft in [`ENCODER_UNIT`]s, at equal distances of the
    /// measured angle from 0 on. That is 0 where the homed joint's angle is 0.
    pub points: [[i16; 16]; ENCODER_POINTS / 16],
}

impl EncoderTable {
    /// No known error.
    pub const NONE: Self = Self {
        shaft_ratio: 0.0,
        points: [[0; 16]; ENCODER_POINTS / 16],
    };

    /// A table of `error` [rad] by the measured angle of the shaft [rad].
    pub fn new(shaft_ratio: f32, error: impl Fn(f64) -> f64) -> Self {
        let step = core::f64::consts::TAU / ENCODER_POINTS as f64;
        let point = |index: usize| {
            let units = error(step * index as f64) / f64::from(ENCODER_UNIT);
            // `as` saturates.
            (units + if units < 0.0 { -0.5 } else { 0.5 }) as i16
        };
        Self {
            shaft_ratio,
            points: core::array::from_fn(|row| {
                core::array::from_fn(|column| point(16 * row + column))
            }),
        }
    }

    /// Whether the ratio is one of a gear, and the error changes slowly enough.
    pub(super) fn is_sound(&self) -> bool {
        if self.shaft_ratio == 0.0 {
            return true;
        }
        let ratio = Scalar::abs(self.shaft_ratio);
        let [least, greatest] =
            const { AxisField::GearRatio.row().range }.map(|ratio| ratio as f32);
        let points = self.points.as_flattened();
        let next = points.iter().cycle().skip(1);
        (least..=greatest).contains(&ratio)
            && points
                .iter()
                .zip(next)
                .all(|(&point, &next)| (i32::from(next) - i32::from(point)).abs() <= STEEPEST)
    }
}
