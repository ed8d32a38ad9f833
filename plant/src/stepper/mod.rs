//! Arms with stepper motors.

mod lag;
mod motor;
mod plant;
mod windings;

use crate::encoder::Harmonics;
use crate::fault::FaultKind;
use crate::mismatch::Mismatch;
pub use motor::{DriverMode, Stepper};
pub use plant::StepperPlant;
pub use windings::{Rotor, Windings};

impl Mismatch {
    /// The name of the first effect that is simulated on brushed motors and encoders only.
    pub fn effect_without_steppers(&self) -> Option<&'static str> {
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
            torque_ripple,
            cogging,
            stiffness: _,
            drive_damping: _,
            backlash: _,
            pulley_run_out: _,
            tooth_mesh: _,
            stiction: _,
            encoder_error,
            encoder_latency,
            supply_resistance,
            pen_friction: _,
            paper_growth: _,
        } = self;
        let exact = |value: &[f64; 2]| *value == [0.0; 2];
        let effects = [
            ("torque_ripple", exact(torque_ripple)),
            ("cogging", exact(cogging)),
            (
                "encoder_error",
                encoder_error.iter().all(Harmonics::is_zero),
            ),
            ("encoder_latency", exact(encoder_latency)),
            ("supply_resistance", *supply_resistance == 0.0),
        ];
        effects
            .into_iter()
            .find_map(|(name, is_exact)| (!is_exact).then_some(name))
    }
}

impl FaultKind {
    /// Whether it happens to an encoder, also to that of a stepper.
    pub fn is_of_encoders(&self) -> bool {
        matches!(
            self,
            Self::EncoderDead { .. }
                | Self::EncoderJump { .. }
                | Self::EncoderGain { .. }
                | Self::EncoderChannelStuck { .. }
                | Self::EncoderNoise { .. }
                | Self::CouplingSlips { .. }
        )
    }

    /// Whether it can happen to an arm with steppers, with and without encoders.
    pub fn is_of_steppers(&self) -> bool {
        matches!(
            self,
            Self::StepLost { .. }
                | Self::PhaseOpen { .. }
                | Self::SwitchStuck { .. }
                | Self::MotorDisconnected { .. }
                | Self::MotorStalled { .. }
                | Self::BeltBreaks { .. }
                | Self::DriverFault { .. }
                | Self::DriverFaultStuck { .. }
                | Self::DriverFaultOpen { .. }
                | Self::EmergencyStop
                | Self::EmergencyStopWelded
                | Self::ContactorWelded
                | Self::BrakeStuck { .. }
                | Self::BrakeLate { .. }
                | Self::BrakeFails { .. }
                | Self::PayloadChanges { .. }
                | Self::ToolCaught
                | Self::TicksMissed { .. }
                | Self::BusVoltage { .. }
        )
    }
}
