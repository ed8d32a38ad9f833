//! The plant's model from a robot file and a mismatch.

use super::chain::{Chain, JOINTS};
use super::dynamics::{Model, State};
use super::motor::Motor;
use super::planar::{Body, PlanarVector, perp, rotation};
use super::sensors::JointSensors;
use crate::input::robot::{MissingMasses, Robot};
use crate::input::scenario::Mismatch;
use fivebar_firmware::Settings;
use fivebar_kinematics::five_bar::Pose;
use nalgebra::Vector2;

fn vector(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(v.x, v.y)
}

impl Model {
    /// The arm of a robot with this mismatch.
    ///
    /// # Errors
    /// The robot has lengths only, no masses.
    pub fn new(robot: &Robot, mismatch: &Mismatch) -> Result<Self, MissingMasses> {
        let arm = robot.arm()?;
        let [l1, l2, l3, l4, base] = robot.geometry.lengths();
        let heavier = 1.0 + mismatch.link_mass;
        let motors = robot.drives()?.map(|drive| Motor {
            gear_ratio: drive.gear_ratio,
            rotor_inertia: drive.rotor_inertia,
            torque_constant: drive.torque_constant,
            resistance: drive.resistance,
            inductance: drive.inductance,
            viscous_friction: drive.viscous_friction * (1.0 + mismatch.friction),
            coulomb_friction: drive.coulomb_friction * (1.0 + mismatch.friction),
        });
        // In its own frame, link j has its joints at (0, 0) and (lj, 0). Along the chain from
        // A to E, links 3 and 4 run from their far ends to their origins.
        let ends = [(0.0, l1), (0.0, l2), (l3, 0.0), (l4, 0.0)];
        let mut bodies = [0, 1, 2, 3].map(|i| {
            let link = &arm.links()[i];
            let com = vector(link.com);
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
        for (body, motor) in [(0, &motors[0]), (3, &motors[1])] {
            bodies[body].inertia += motor.rotor_inertia * motor.gear_ratio * motor.gear_ratio;
        }
        let [along, aside] = robot.tool.offset;
        let com2 = vector(arm.links()[1].com) + shift;
        Ok(Self {
            chain: Chain {
                bodies,
                pivots: [Vector2::zeros(), Vector2::new(base, 0.0)],
                constrained: [true; JOINTS],
            },
            motors,
            gravity: vector(arm.gravity()),
            tool: Vector2::new(l2 + along, aside) - com2,
        })
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
        Self {
            counts_per_turn: f64::from(axis.encoder_counts) * f64::from(axis.gear_ratio),
            home: f64::from(axis.home_angle),
            home_forward: axis.home_forward,
            current_per_code: f64::from(axis.current_per_code),
            current_zero_code: f64::from(axis.current_zero_code),
            current_offset: mismatch.current_offset,
            current_noise: mismatch.current_noise,
        }
    }
}
