//! Arms with torque drives on a CAN bus.

mod bus;
mod drive;
mod mistakes;
mod plant;
mod protocol;
mod wires;

use crate::fault::FaultKind;
use crate::mismatch::Mismatch;
pub use bus::bits_on_bus;
pub use drive::{BOOT, CanDrive};
pub use plant::CanPlant;
pub use wires::{BusEvent, Wires};

impl Mismatch {
    /// The name of the first effect that is simulated with brushed motors only.
    pub fn effect_without_torque_drives(&self) -> Option<&'static str> {
        // Whether a key acts on these drives: one without a line here does not compile.
        let Self {
            link_mass: _,
            friction: _,
            payload: _,
            current_noise: _,
            current_offset: _,
            link_length: _,
            base_length: _,
            home_error: _,
            torque_constant: _,
            torque_ripple: _,
            cogging: _,
            stiffness: _,
            drive_damping: _,
            backlash: _,
            pulley_run_out: _,
            tooth_mesh: _,
            stiction: _,
            encoder_error: _,
            encoder_latency: _,
            supply_resistance,
            pen_friction: _,
            paper_growth: _,
        } = self;
        (*supply_resistance != 0.0).then_some("supply_resistance")
    }
}

impl FaultKind {
    /// Whether it can happen to an arm with torque drives on a bus.
    pub fn is_of_torque_drives(&self) -> bool {
        self.is_of_bus()
            || matches!(
                self,
                Self::EncoderDead { .. }
                    | Self::EncoderJump { .. }
                    | Self::EncoderGain { .. }
                    | Self::EncoderNoise { .. }
                    | Self::SwitchStuck { .. }
                    | Self::MotorDisconnected { .. }
                    | Self::MotorStalled { .. }
                    | Self::CouplingSlips { .. }
                    | Self::EmergencyStop
                    | Self::EmergencyStopWelded
                    | Self::BrakeStuck { .. }
                    | Self::BrakeLate { .. }
                    | Self::BrakeFails { .. }
                    | Self::PayloadChanges { .. }
                    | Self::ToolCaught
                    | Self::TicksMissed { .. }
            )
    }

    /// Whether it needs a bus.
    pub fn is_of_bus(&self) -> bool {
        matches!(
            self,
            Self::CanSilent { .. } | Self::CanReset { .. } | Self::CanBusOff
        )
    }
}
