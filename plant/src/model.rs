//! The plant's model, made of the arm as the controller knows it and of a mismatch.

use crate::chain::{Chain, JOINTS};
use crate::dynamics::{CARRIER, DRIVEN, Model, State};
use crate::mismatch::Mismatch;
use crate::motor::Motor;
use crate::parameters::Parameters;
use crate::planar::{Body, PlanarVector, perp, rotation, times};
use crate::sensors::JointSensors;
use fivebar_firmware::Settings;
use fivebar_firmware::settings::HomingMethod;
use fivebar_kinematics::five_bar::{Joint, Pose};
use nalgebra::Vector2;
use std::f64::consts::TAU;

impl Model {
    /// The arm with this mismatch. [`Drives`](crate::Drives) has the rotors behind springs.
    pub fn new(parameters: &Parameters, mismatch: &Mismatch) -> Self {
        let arm = &parameters.arm;
        let [l1, l2, l3, l4, base] = mismatch.lengths(arm.geometry().lengths());
        let heavier = 1.0 + mismatch.link_mass;
        let motors = Joint::ALL.map(|joint| {
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
        for (joint, body) in Joint::ALL.into_iter().zip(DRIVEN) {
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
    /// The sensors of a joint, as in the controller's settings, with this mismatch.
    pub fn new(settings: &Settings, mismatch: &Mismatch, joint: Joint) -> Self {
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
            shown_at_home: home,
            switch: home + if axis.home_forward { behind } else { -behind },
            home_forward: axis.home_forward,
            current_per_code: f64::from(axis.current_per_code),
            current_zero_code: f64::from(axis.current_zero_code),
            current_offset: mismatch.current_offset,
            current_noise: mismatch.current_noise,
        }
    }
}
