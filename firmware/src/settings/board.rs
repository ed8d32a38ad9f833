//! What a board can do with settings that are valid by themselves.

use super::{HomingMethod, Settings, SettingsError};
use core::f32::consts::TAU;
use fivebar_kinematics::Scalar;

/// The bounds of a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoardLimits {
    /// Its one tick rate [Hz].
    pub tick_rate: u32,
    /// Encoder counts per second that the filters at its inputs pass, or micro-steps per second that it makes.
    pub count_rate: u32,
    /// Greatest motor current that the bridges stand [A].
    pub current: u32,
    /// Greatest bus voltage that the bridges stand [V].
    pub bus_voltage: u32,
    /// Whether its counters show the joints' angles from power-up on.
    pub absolute_encoders: bool,
    /// Whether its drives are on a CAN bus.
    pub drives_on_bus: bool,
    /// Whether it makes the pulses of hobby servos, and nothing else.
    pub hobby_servos: bool,
}

impl BoardLimits {
    /// The STM32F405 as wired in `docs/use/wiring.md`.
    pub const STM32F405: Self = Self {
        tick_rate: 10_000,
        count_rate: 1_500_000,
        current: 6,
        bus_voltage: 36,
        // Its counters start at 0 wherever the arm stands.
        absolute_encoders: false,
        drives_on_bus: false,
        hobby_servos: false,
    };

    /// The STM32F405 with stepper drivers. They measure no current, and its board no voltage.
    pub const STM32F405_STEPPER: Self = Self {
        // 20 steps in a tick.
        count_rate: 200_000,
        current: u32::MAX,
        bus_voltage: u32::MAX,
        ..Self::STM32F405
    };

    /// The STM32F405 with torque drives on its CAN bus, which count and guard their motors themselves. The tick rate is that
    /// at which both protocols' frames fit on the bus: `drives::can::most_load`.
    pub const STM32F405_CAN: Self = Self {
        tick_rate: 1_000,
        count_rate: u32::MAX,
        absolute_encoders: true,
        drives_on_bus: true,
        ..Self::STM32F405_STEPPER
    };

    /// The RP2350 with stepper drivers: as many steps in a tick.
    pub const RP2350_STEPPER: Self = Self::STM32F405_STEPPER;

    /// The RP2350 with hobby servos.
    pub const RP2350_SERVO: Self = Self {
        // 2.4 ms of half microseconds in a frame of 50 Hz.
        count_rate: 240_000,
        // A servo knows its angle.
        absolute_encoders: true,
        hobby_servos: true,
        ..Self::STM32F405_STEPPER
    };

    /// Checks what the board must follow: the tick rate, and the encoders at the speed that is a
    /// fault; that the current and the voltage that are faults do not destroy its bridges; and that
    /// it has the encoders from which the angles are to come, and the drives.
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
        if !follows {
            return Err(SettingsError::BoardCountRate(self.count_rate));
        }
        let protection = &settings.protection;
        if protection.over_current > self.current as f32 {
            return Err(SettingsError::BoardCurrent(self.current));
        }
        let [_, high] = protection.bus_voltage;
        if high > self.bus_voltage as f32 {
            return Err(SettingsError::BoardVoltage(self.bus_voltage));
        }
        let absolute = settings.home_reference.method == HomingMethod::Absolute;
        if absolute && !self.absolute_encoders {
            return Err(SettingsError::BoardEncoders);
        }
        if self.drives_on_bus && settings.bus_drives().is_none() {
            return Err(SettingsError::BoardBus);
        }
        if self.hobby_servos && settings.servo_pulses().is_none() {
            return Err(SettingsError::BoardServos);
        }
        Ok(())
    }
}
