//! The correction of an encoder's known error.
//!
//! Between two points of the table the error is a straight line, so the true angle is a straight
//! line over the counts: an angle at the origin and an angle per count, which every tick uses. A turn
//! changes both when the encoder has passed a point.

use crate::settings::{AxisSettings, ENCODER_POINTS, ENCODER_UNIT, EncoderTable, Settings};
use core::f32::consts::TAU;

/// An encoder with a known error. Its measured angle is counted in intervals of the table.
#[derive(Clone)]
pub(super) struct Encoder {
    intervals_per_count: f32,
    /// Per angle of the joint [1/rad].
    intervals_per_radian: f32,
    /// Of the joint, without the correction [rad].
    radians_per_count: f32,
    /// Angle of the joint per unit of a point [rad].
    radians_per_unit: f32,
    /// The same once the joint's angle is known, 0 before.
    correction: f32,
    points: [[i16; 16]; ENCODER_POINTS / 16],
    /// The measured angle where the joint is at its home angle [intervals].
    pub(super) shown_at_home: f32,
    /// The measured angle at the origin less half an interval [intervals].
    shown_at_origin: f32,
    /// The joint's angle at the origin without the correction [rad].
    uncorrected: f32,
    /// The interval of the correction in use, in its last bits.
    interval: u32,
}

/// A joint's angle over its counts: `at_origin` + `per_count` n [rad].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    pub(super) at_origin: f32,
    pub(super) per_count: f32,
}

/// 1.5·2²³: adding it rounds to a whole number, whose last bits are then the sum's.
const ROUND: f32 = 12_582_912.0;

/// No interval.
const NONE: u32 = 0;

impl Encoder {
    /// The encoder of a joint; none without a known error.
    // A call of its own: the other encoder takes no stack meanwhile.
    #[inline(never)]
    fn new(table: &EncoderTable, axis: &AxisSettings) -> Option<Self> {
        let ratio = table.shaft_ratio;
        if ratio == 0.0 {
            return None;
        }
        let radians_per_count = TAU / (axis.encoder_counts as f32 * axis.gear_ratio);
        let intervals_per_radian = ratio * (ENCODER_POINTS as f32 / TAU);
        let mut encoder = Self {
            intervals_per_count: intervals_per_radian * radians_per_count,
            intervals_per_radian,
            radians_per_count,
            radians_per_unit: ENCODER_UNIT / ratio,
            correction: 0.0,
            points: table.points,
            shown_at_home: 0.0,
            shown_at_origin: 0.0,
            uncorrected: 0.0,
            interval: NONE,
        };
        encoder.shown_at_home = encoder.shown_at(axis.home_angle);
        Some(encoder)
    }

    /// The points before and after an interval.
    #[inline(always)]
    fn points(&self, interval: u32) -> [f32; 2] {
        let points = self.points.as_flattened();
        let at = |index: u32| {
            let point = points.get(index as usize % ENCODER_POINTS);
            f32::from(point.copied().unwrap_or(0))
        };
        [at(interval), at(interval.wrapping_add(1))]
    }

    /// The error [units] at a measured angle [intervals].
    fn error(&self, shown: f32) -> f32 {
        let rounded = (shown - 0.5) + ROUND;
        let [before, after] = self.points(rounded.to_bits());
        before + (shown - (rounded - ROUND)) * (after - before)
    }

    /// The measured angle [intervals] where the joint is at `angle` [rad]. The error changes by at
    /// most a third of the angle, so each round divides what is left by three.
    pub(super) fn shown_at(&self, angle: f32) -> f32 {
        let intervals_per_unit = self.radians_per_unit * self.intervals_per_radian;
        let shaft = self.intervals_per_radian * angle;
        (0..16).fold(shaft, |shown, _| {
            shaft + intervals_per_unit * self.error(shown)
        })
    }

    /// The joint is at `angle` [rad], and shows `shown` [intervals], at the origin.
    pub(super) fn set_origin(&mut self, angle: f32, shown: f32) {
        self.correction = self.radians_per_unit;
        self.uncorrected = angle + self.correction * self.error(shown);
        self.shown_at_origin = shown - 0.5;
        self.interval = NONE;
    }

    /// The joint's angle over its counts, so many counts from the origin; none if the correction in
    /// use is that.
    #[inline(always)]
    pub(super) fn scale(&mut self, counts: i32) -> Option<Scale> {
        let origin = self.shown_at_origin;
        let rounded = origin + self.intervals_per_count * counts as f32 + ROUND;
        let interval = rounded.to_bits();
        if interval == self.interval {
            return None;
        }
        self.interval = interval;
        let [before, after] = self.points(interval);
        let rise = self.correction * (after - before);
        let error = self.correction * before + rise * ((origin + 0.5) - (rounded - ROUND));
        Some(Scale {
            at_origin: self.uncorrected - error,
            per_count: self.radians_per_count - rise * self.intervals_per_count,
        })
    }
}

/// What encoders with a known error show where the joints are at these angles [rad]; 0 without one.
pub(super) fn shown_at(settings: &Settings, angles: [f32; 2]) -> [f32; 2] {
    let ([encoder1, encoder4], [angle1, angle4]) = (&encoders(settings), angles);
    [(encoder1, angle1), (encoder4, angle4)].map(|(encoder, angle)| {
        encoder
            .as_ref()
            .map_or(0.0, |encoder| encoder.shown_at(angle))
    })
}

/// The encoders of both joints that have a known error.
pub(super) fn encoders(settings: &Settings) -> [Option<Encoder>; 2] {
    let ([table1, table4], [axis1, axis4]) = (&settings.encoder_tables, &settings.axes);
    [Encoder::new(table1, axis1), Encoder::new(table4, axis4)]
}

#[cfg(test)]
mod tests;
