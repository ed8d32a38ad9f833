//! What stretches between the motors and their joints.

use super::{AxisSettings, Settings};
use fivebar_kinematics::control::{Belt, BeltGains, BeltLaw};
use serde::{Deserialize, Serialize};

/// The greatest encoder latency of an arm on belts, in ticks.
pub const MOST_LATE_TICKS: usize = 7;

/// The greatest stiffness at a joint [N·m/rad].
const MOST_STIFFNESS: f32 = 1e7;

/// A belt between a motor and its joint, or what else stretches there, and the loop that knows it. Without
/// stiffness the drive is rigid: the loop is that of [`ControlSettings`](super::ControlSettings). The field of a stepper
/// is a spring without a loop: it leads its rotor by the load.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BeltSettings {
    /// Stiffness at the joint [N·m/rad]; 0: rigid.
    pub stiffness: f32,
    /// Damping at the joint [N·m·s/rad].
    pub damping: f32,
    /// Whether the encoder is at the joint; else it is at the motor.
    pub encoder_at_joint: bool,
    /// Bandwidth of the feedback from the links [rad/s].
    pub bandwidth: f32,
    /// Its damping ratio.
    pub damping_ratio: f32,
    /// Torque against the rotor's velocity [N·m·s/rad].
    pub rotor_damping: f32,
    /// Gains of the observer, see `fivebar_kinematics::control::BeltGains`.
    pub observer: [f32; 5],
}

impl BeltSettings {
    /// A rigid drive.
    pub const RIGID: Self = Self {
        stiffness: 0.0,
        damping: 0.0,
        encoder_at_joint: false,
        bandwidth: 0.0,
        damping_ratio: 0.0,
        rotor_damping: 0.0,
        observer: [0.0; 5],
    };

    /// The field of a stepper with this stiffness at the joint [N·m/rad], and no loop.
    pub const fn spring(stiffness: f32) -> Self {
        Self {
            stiffness,
            ..Self::RIGID
        }
    }

    /// The law of this joint, with this share of the bandwidth of a moving arm; the lags are those of the torque
    /// behind its demand, and behind the sample [s].
    pub(crate) fn law(
        &self,
        axis: &AxisSettings,
        share: f32,
        [drive_lag, lag]: [f32; 2],
        period: f32,
    ) -> BeltLaw<f32> {
        let belt = Belt {
            stiffness: self.stiffness,
            damping: self.damping,
            rotor_inertia: axis.gear_ratio * axis.gear_ratio * axis.rotor_inertia,
            encoder_at_joint: self.encoder_at_joint,
        };
        let [g1, g2, g3, g4, g5] = self.observer;
        let gains = BeltGains {
            bandwidth: share * self.bandwidth,
            damping: self.damping_ratio,
            rotor_damping: self.rotor_damping,
            observer: [g1, g2, g3, g4, share * g5],
        };
        BeltLaw::new(&belt, &gains, drive_lag, lag, period)
    }

    /// Whether it is a spring without a loop.
    fn is_spring(&self) -> bool {
        self.stiffness > 0.0
            && self.stiffness <= MOST_STIFFNESS
            && *self == Self::spring(self.stiffness)
    }

    /// Whether its numbers are those of a loop. Within these bounds nothing overflows.
    fn is_sound(&self) -> bool {
        let positive = |value: f32, most: f32| value > 0.0 && value <= most;
        let gains = self.observer.iter();
        positive(self.stiffness, MOST_STIFFNESS)
            && (0.0..=1e4).contains(&self.damping)
            && positive(self.bandwidth, 1e4)
            && positive(self.damping_ratio, 10.0)
            && (0.0..=1e4).contains(&self.rotor_damping)
            && gains.into_iter().all(|&gain| (0.0..=1e6).contains(&gain))
    }
}

impl Settings {
    /// Whether both joints are on belts with loops.
    pub fn is_on_belts(&self) -> bool {
        self.belts.iter().all(|belt| belt.bandwidth != 0.0)
    }

    /// Whether both drives are rigid, or both fields of steppers, or both on belts with sound loops.
    pub(super) fn belts_are_sound(&self) -> bool {
        if self.belts == [BeltSettings::RIGID; 2] || self.belts.iter().all(BeltSettings::is_spring)
        {
            return true;
        }
        let late = MOST_LATE_TICKS as f32 + 0.5;
        self.belts.iter().all(BeltSettings::is_sound)
            && self.axes.iter().all(|axis| {
                axis.rotor_inertia > 0.0 && axis.encoder_latency * self.control.tick_rate < late
            })
    }
}
