//! The arm as the controller knows it.

use crate::encoder::Encoder;
use crate::motor::Motor;
use crate::transmission::Transmission;
use fivebar_firmware::Settings;
use fivebar_firmware::settings::SettingsError;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::Geometry;

/// The arm, its drives and its sensors without any mismatch. Index 0 of a pair is joint 1,
/// index 1 joint 4.
#[derive(Clone, Debug)]
pub struct Parameters {
    /// Geometry and inertia.
    pub arm: Arm<f64>,
    /// The tool's position from C, along link 2 and to its left [m].
    pub tool_offset: [f64; 2],
    /// The motors.
    pub motors: [Motor; 2],
    /// The gears or belts.
    pub transmissions: [Transmission; 2],
    /// The encoders.
    pub encoders: [Encoder; 2],
    /// Torques of the holding brakes [N·m]; zero without a brake.
    pub brake_torque: [f64; 2],
    /// Times in which each brake engages and releases [s].
    pub brake_times: [[f64; 2]; 2],
    /// Bus voltage [V].
    pub bus_voltage: f64,
    /// Bus voltage per ADC code [V].
    pub volts_per_code: f64,
    /// Joint angles at which the home switches close [rad], where these are not the home angles; on an
    /// arm with index pulses, none are half a turn of the encoder behind them.
    pub switches: Option<[f64; 2]>,
    /// The controller's settings, which the sensors are scaled by.
    pub settings: Settings,
}

impl Parameters {
    /// The arm that a controller's settings describe, with rigid drives,
    /// encoders without error and no brakes, at this bus voltage [V].
    ///
    /// # Errors
    /// Lengths or inertias that are not an arm's.
    pub fn from_settings(settings: &Settings, bus_voltage: f64) -> Result<Self, SettingsError> {
        let wide = |pair: [f32; 2]| pair.map(f64::from);
        let geometry =
            Geometry::new(settings.lengths.map(f64::from)).map_err(SettingsError::Geometry)?;
        let links = settings.links.map(|link| Link {
            mass: link.mass.into(),
            com: wide(link.com).into(),
            inertia: link.inertia.into(),
        });
        let motors = settings.axes.map(|axis| Motor {
            gear_ratio: axis.gear_ratio.into(),
            rotor_inertia: axis.rotor_inertia.into(),
            torque_constant: axis.torque_constant.into(),
            resistance: axis.resistance.into(),
            inductance: axis.inductance.into(),
            viscous_friction: axis.viscous_friction.into(),
            coulomb_friction: axis.coulomb_friction.into(),
        });
        let rotors = motors.map(|motor| motor.gear_ratio.powi(2) * motor.rotor_inertia);
        let payload = settings.payload.into();
        let gravity = wide(settings.gravity).into();
        Ok(Self {
            arm: Arm::new(geometry, links, payload, gravity, rotors)
                .map_err(SettingsError::Inertia)?,
            tool_offset: wide(settings.tool_offset),
            motors,
            transmissions: [Transmission::default(); 2],
            encoders: [Encoder::default(); 2],
            brake_torque: [0.0; 2],
            brake_times: [[0.0; 2]; 2],
            bus_voltage,
            volts_per_code: settings.protection.bus_voltage_per_code.into(),
            switches: None,
            settings: *settings,
        })
    }
}
