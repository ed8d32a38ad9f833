//! A log of an arm's motion, and what is known of the arm.

use fivebar_kinematics::five_bar::{Geometry, Joint, Side, WorkingMode};
use nalgebra::Vector2;

/// A log with a row for every tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// Time [s].
    pub times: Vec<f64>,
    /// θ1, θ4 [rad], each up to whole turns.
    pub angles: Vec<[f64; 2]>,
    /// The motors' currents [A], positive for positive torque at the joint. That of row k acted
    /// from tick k − 1 to tick k.
    pub currents: Vec<[f64; 2]>,
}

impl Log {
    /// The torques at the joints [N·m].
    pub(super) fn torques(&self, observed: &Observed<'_>) -> [Vec<f64>; 2] {
        Joint::ALL.map(|joint| {
            let factor = observed.torque_per_ampere[joint];
            self.currents
                .iter()
                .map(|row| factor * row[joint])
                .collect()
        })
    }
}

/// What is known of the arm of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observed<'a> {
    /// The lengths.
    pub geometry: &'a Geometry<f64>,
    /// The assembly mode.
    pub assembly: Side,
    /// The working mode of C.
    pub mode: WorkingMode,
    /// In the plane [m/s²].
    pub gravity: Vector2<f64>,
    /// Torque at the joint per current [N·m/A].
    pub torque_per_ampere: [f64; 2],
    /// Greatest current of each motor [A].
    pub current_limit: [f64; 2],
    /// Tick rate [Hz].
    pub tick_rate: f64,
}

impl Observed<'_> {
    /// 7 base parameters on a level arm, 11 with gravity.
    pub fn base_count(&self) -> usize {
        if self.gravity == Vector2::zeros() {
            7
        } else {
            11
        }
    }
}
