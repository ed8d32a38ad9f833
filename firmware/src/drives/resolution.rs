//! How finely a stepper steps, and the numbers that follow from it.

use serde::{Deserialize, Serialize};

/// How finely a motor steps: as its driver is set, which the board knows. The default, 0, is that of a motor without an
/// encoder: a turn has as many micro-steps as the axis settings have counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Resolution {
    /// Full steps in a turn of the motor.
    pub full_steps: u16,
    /// Micro-steps in a full step.
    pub microsteps: u16,
}

impl Resolution {
    /// Micro-steps in a turn of the motor.
    fn per_turn(self) -> f32 {
        f32::from(self.full_steps) * f32::from(self.microsteps)
    }

    /// A resolution with so many micro-steps in a turn, for a motor whose counts are its micro-steps: with 200 full steps if
    /// it can be. How both share them changes no more than how far the lead of a heavy load is from proportional. None for
    /// a number that it cannot express, an odd one above 65 535.
    pub(super) fn of_turn(microsteps: u32) -> Self {
        if let (0, Ok(microsteps)) = (microsteps % 200, u16::try_from(microsteps / 200)) {
            return Self {
                full_steps: 200,
                microsteps,
            };
        }
        let zeros = microsteps.trailing_zeros().min(15);
        Self {
            full_steps: u16::try_from(microsteps >> zeros).unwrap_or(0),
            microsteps: 1 << zeros,
        }
    }
}

/// What follows from a resolution.
#[derive(Clone, Copy)]
pub(super) struct Fineness {
    /// Micro-steps in a turn of the motor.
    pub(super) per_turn: f32,
    /// Micro-steps in a full step.
    pub(super) per_full_step: f32,
    /// Periods of the field in a turn of the motor, N.
    pub(super) periods: f32,
    /// The most micro-steps in a tick.
    pub(super) most: i32,
}

impl Fineness {
    /// Of a motor that makes so many turns in a tick at most.
    #[inline(always)]
    pub(super) fn new(resolution: Resolution, fastest: f32) -> Self {
        let per_turn = resolution.per_turn();
        Self {
            per_turn,
            per_full_step: f32::from(resolution.microsteps),
            periods: 0.25 * f32::from(resolution.full_steps),
            // `as` cuts: one more.
            most: (fastest * per_turn) as i32 + 1,
        }
    }
}
