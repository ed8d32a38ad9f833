//! What a board can do with settings that are valid by themselves.

use super::{Settings, SettingsError};
use core::f32::consts::TAU;
use fivebar_kinematics::Scalar;

/// The bounds of a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoardLimits {
    /// Its one tick rate [Hz].
    pub tick_rate: u32,
    /// Encoder counts per second that the filters at its inputs pass.
    pub count_rate: u32,
}

impl BoardLimits {
    /// The STM32F405 as wired in `docs/wiring.md`.
    pub const STM32F405: Self = Self {
        tick_rate: 10_000,
        count_rate: 1_500_000,
    };

    /// Checks what the board must follow: the tick rate, and the encoders at the speed that is a
    /// fault.
    ///
    /// # Errors
    /// The field beyond the board's bound, with the bound.
    pub fn check(&self, settings: &Settings) -> Result<(), SettingsError> {
        if settings.control.tick_rate != self.tick_rate as f32 {
            return Err(SettingsError::BoardTickRate(self.tick_rate));
        }
        let follows = settings.axes.iter().all(|axis| {
            let counts_per_turn = axis.encoder_counts as f32 * Scalar::abs(axis.gear_ratio);
            settings.protection.over_speed * counts_per_turn <= TAU * self.count_rate as f32
        });
        if follows {
            Ok(())
        } else {
            Err(SettingsError::BoardCountRate(self.count_rate))
        }
    }
}
