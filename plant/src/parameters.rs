//! The arm as the controller knows it, and the plant's model made of it and a mismatch.

use crate::chain::{Chain, JOINTS};
use crate::dynamics::{CARRIER, DRIVEN, Model, State};
use crate::encoder::Encoder;
use crate::mismatch::Mismatch;
use crate::motor::Motor;
use crate::planar::{Body, PlanarVector, perp, rotation, times};
use crate::sensors::JointSensors;
use crate::transmission::Transmission;
use fivebar_firmware::Settings;
use fivebar_firmware::settings::{HomingMethod, SettingsError};
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Pose};
use nalgebra::Vector2;
use std::f64::consts::TAU;

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

impl Model {
    /// The arm with this mismatch. [`Drives`](crate::Drives) has the rotors behind springs.
    pub fn new(parameters: &Parameters, mismatch: &Mismatch) -> Self {
        let arm = &parameters.arm;
        let [l1, l2, l3, l4, base] = mismatch.lengths(arm.geometry().lengths());
        let heavier = 1.0 + mismatch.link_mass;
        let motors = [0, 1].map(|joint| {
            let motor = parameters.motors[joint];
            Motor {
                torque_constant: motor.torque_constant * (1.0 + mismatch.torque_constant[joint]),
                viscous_friction: motor.viscous_friction * (1.0 + mismatch.friction),
                coulomb_friction: motor.coulomb_friction * (1.0 + mismatch.friction),
                ..motor
            }
        });
        // In its own frame, link j has its joints at (0, 0) and (lj, 0). Along the chain from
        // A to E, links 3 and 4 run from their far ends to their origins.
        let ends = [(0.0, l1), (0.0, l2), (l3, 0.0), (l4, 0.0)];
        let mut bodies = [0, 1, 2, 3].map(|i| {
            let link = &arm.links()[i];
            let com = link.com;
            let (near, far) = ends[i];
            Body {
                mass: link.mass * heavier,
                inertia: link.inertia * heavier,
                near: Vector2::new(near, 0.0) - com,
                far: Vector2::new(far, 0.0) - com,
            }
        });
        let payload = arm.payload() + mismatch.payload;
        let shift = add_point_mass(&mut bodies[1], payload);
        for (joint, body) in DRIVEN.into_iter().enumerate() {
            if mismatch.spring(parameters, joint).is_none() {
                bodies[body].inertia += motors[joint].reflected_inertia();
            }
        }
        let [along, aside] = parameters.tool_offset;
        let com2 = arm.links()[1].com + shift;
        Self {
            chain: Chain {
                bodies,
                pivots: [Vector2::zeros(), Vector2::new(base, 0.0)],
                constrained: [true; JOINTS],
            },
            motors,
            gravity: arm.gravity(),
            tool: Vector2::new(l2 + along, aside) - com2,
            finer_steps: 1.0,
        }
    }

    /// Changes the payload by this mass [kg] while the arm moves: neither the links nor their
    /// velocities change at that instant, but link 2's centre of mass does.
    pub(crate) fn change_payload(&mut self, state: &mut State, mass: f64) {
        let body = &mut self.chain.bodies[CARRIER];
        let shift = add_point_mass(body, mass);
        self.tool -= shift;
        let shift = times(&rotation(state.q[CARRIER].angular), shift);
        state.q[CARRIER].linear += shift;
        let turning = perp(shift) * state.v[CARRIER].angular;
        state.v[CARRIER].linear += turning;
    }

    /// The arm in a pose with the angular velocities `omega`, ω1…ω4 [rad/s], without currents.
    pub fn state_at(&self, pose: &Pose<f64>, omega: [f64; 4]) -> State {
        let angles = pose.angles();
        let mut q = [PlanarVector::ZERO; 4];
        let mut v = [PlanarVector::ZERO; 4];
        // Outwards from both pivots: position and velocity of each link's first point.
        for (leg, pivot) in [
            ([0, 1], self.chain.pivots[0]),
            ([3, 2], self.chain.pivots[1]),
        ] {
            let (mut start, mut velocity) = (pivot, Vector2::zeros());
            for i in leg {
                let body = &self.chain.bodies[i];
                let (proximal, distal) = if i < 2 {
                    (body.near, body.far)
                } else {
                    (body.far, body.near)
                };
                let rotation = rotation(angles[i]);
                let to_com = -(rotation * proximal);
                let to_end = rotation * (distal - proximal);
                q[i] = PlanarVector {
                    linear: start + to_com,
                    angular: angles[i],
                };
                v[i] = PlanarVector {
                    linear: velocity + perp(to_com) * omega[i],
                    angular: omega[i],
                };
                start += to_end;
                velocity += perp(to_end) * omega[i];
            }
        }
        self.chain.close_joints(&mut q, &mut v);
        State {
            q,
            v,
            current: [0.0; 2],
        }
    }
}

/// Adds a point mass [kg] at the far end of a body. Returns the shift of its centre of
/// mass [m].
fn add_point_mass(body: &mut Body, mass: f64) -> Vector2<f64> {
    let total = body.mass + mass;
    let shift = body.far * (mass / total);
    // Steiner: m₁ m₂/(m₁ + m₂) d².
    body.inertia += body.mass * mass / total * perp(body.far).norm_squared();
    body.mass = total;
    body.near -= shift;
    body.far -= shift;
    shift
}

impl JointSensors {
    /// The sensors of a joint, 0 or 1, as in the controller's settings, with this mismatch.
    pub fn new(settings: &Settings, mismatch: &Mismatch, joint: usize) -> Self {
        let axis = &settings.axes[joint];
        let counts_per_turn = f64::from(axis.encoder_counts) * f64::from(axis.gear_ratio);
        let home = f64::from(axis.home_angle) + mismatch.home_error[joint];
        let behind = match settings.home_reference.method {
            HomingMethod::Index => 0.5 * TAU * f64::from(axis.index_counts) / counts_per_turn.abs(),
            _ => 0.0,
        };
        Self {
            counts_per_turn,
            home,
            switch: home + if axis.home_forward { behind } else { -behind },
            home_forward: axis.home_forward,
            current_per_code: f64::from(axis.current_per_code),
            current_zero_code: f64::from(axis.current_zero_code),
            current_offset: mismatch.current_offset,
            current_noise: mismatch.current_noise,
        }
    }
}
