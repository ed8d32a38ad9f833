//! What a five-bar can be asked: positions, motion and dynamics both ways.

use super::{Kind, Refusal};
use crate::input::robot::Robot;
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{Accelerations, Pose, PoseError, Side, Velocities, WorkingMode};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A question. SI units, absolute angles; C is the point where links 2 and 3 meet.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(tag = "op", rename_all = "snake_case")]
pub enum Request {
    /// Where C is.
    Forward(Driven),
    /// How to bring C somewhere.
    Inverse(Inverse),
    /// Velocities and accelerations.
    Motion(Motion),
    /// The torques of a motion.
    InverseDynamics(InverseDynamics),
    /// The motion of torques.
    ForwardDynamics(ForwardDynamics),
}

/// The driven angles [rad] and the forward branch.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Driven {
    theta1: f64,
    theta4: f64,
    assembly: Side,
}

/// C [m] and the inverse branch.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Inverse {
    c: [f64; 2],
    elbow1: Side,
    elbow4: Side,
}

/// The driven joints' angles, rates [rad/s] and accelerations [rad/s²].
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Motion {
    #[serde(flatten)]
    driven: Driven,
    omega1: f64,
    omega4: f64,
    alpha1: f64,
    alpha4: f64,
}

/// A motion with a force [N] on C.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct InverseDynamics {
    #[serde(flatten)]
    motion: Motion,
    external_force: [f64; 2],
}

/// Angles and rates with torques [N·m] on links 1 and 4, and a force [N] on C.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct ForwardDynamics {
    #[serde(flatten)]
    driven: Driven,
    omega1: f64,
    omega4: f64,
    torque: [f64; 2],
    external_force: [f64; 2],
}

#[derive(Serialize)]
struct ForwardAnswer {
    c: [f64; 2],
    theta2: f64,
    theta3: f64,
    elbow1: Side,
    elbow4: Side,
}

#[derive(Serialize)]
struct InverseAnswer {
    theta1: f64,
    theta4: f64,
    theta2: f64,
    theta3: f64,
    assembly: Side,
}

#[derive(Serialize)]
struct MotionAnswer {
    c: [f64; 2],
    c_velocity: [f64; 2],
    c_acceleration: [f64; 2],
    omega2: f64,
    omega3: f64,
    alpha2: f64,
    alpha3: f64,
}

#[derive(Serialize)]
struct InverseDynamicsAnswer {
    torque: [f64; 2],
    mass_matrix: [[f64; 2]; 2],
    bias_torque: [f64; 2],
    reaction: Reaction,
}

/// Forces in the joints: a ground on link 1, b link 1 on link 2, c link 2 on link 3,
/// d link 4 on link 3, e ground on link 4.
#[derive(Serialize)]
struct Reaction {
    a: [f64; 2],
    b: [f64; 2],
    c: [f64; 2],
    d: [f64; 2],
    e: [f64; 2],
}

#[derive(Serialize)]
struct ForwardDynamicsAnswer {
    alpha1: f64,
    alpha4: f64,
}

/// The answer to a question about a robot.
///
/// # Errors
/// What has no answer, with the reason.
pub fn answer(robot: &Robot, request: Request) -> Result<Value, Refusal> {
    match request {
        Request::Forward(driven) => driven.answer(robot).map(|answer| json!(answer)),
        Request::Inverse(inverse) => inverse.answer(robot).map(|answer| json!(answer)),
        Request::Motion(motion) => motion.answer(robot).map(|answer| json!(answer)),
        Request::InverseDynamics(ask) => ask.answer(robot).map(|answer| json!(answer)),
        Request::ForwardDynamics(ask) => ask.answer(robot).map(|answer| json!(answer)),
    }
}

impl Driven {
    fn pose(&self, robot: &Robot) -> Result<Pose<f64>, Refusal> {
        let Self {
            theta1,
            theta4,
            assembly,
        } = *self;
        robot
            .geometry
            .forward(theta1, theta4, assembly)
            .map_err(|error| self.refuse(error))
    }

    fn refuse(&self, error: PoseError) -> Refusal {
        let Self { theta1, theta4, .. } = self;
        refusal(
            error,
            &format!("at θ1 = {theta1:?} rad, θ4 = {theta4:?} rad"),
        )
    }

    fn answer(&self, robot: &Robot) -> Result<ForwardAnswer, Refusal> {
        let pose = self.pose(robot)?;
        let [_, theta2, theta3, _] = pose.angles();
        let WorkingMode { elbow1, elbow4 } = pose.working_mode();
        Ok(ForwardAnswer {
            c: array(pose.c),
            theta2,
            theta3,
            elbow1,
            elbow4,
        })
    }
}

impl Inverse {
    fn answer(&self, robot: &Robot) -> Result<InverseAnswer, Refusal> {
        let [x, y] = self.c;
        let mode = WorkingMode::new(self.elbow1, self.elbow4);
        let pose = robot
            .geometry
            .inverse(vec2(self.c), mode)
            .map_err(|error| refusal(error, &format!("with C at ({x:?}, {y:?}) m")))?;
        let [theta1, theta2, theta3, theta4] = pose.angles();
        Ok(InverseAnswer {
            theta1,
            theta4,
            theta2,
            theta3,
            assembly: pose.assembly(),
        })
    }
}

/// A motion in full.
struct Solved {
    pose: Pose<f64>,
    velocities: Velocities<f64>,
    accelerations: Accelerations<f64>,
}

impl Motion {
    fn solve(&self, robot: &Robot) -> Result<Solved, Refusal> {
        let pose = self.driven.pose(robot)?;
        let geometry = &robot.geometry;
        let velocities = geometry
            .forward_velocities(&pose, self.omega1, self.omega4)
            .map_err(|error| self.driven.refuse(error))?;
        let accelerations = geometry
            .forward_accelerations(&pose, &velocities, self.alpha1, self.alpha4)
            .map_err(|error| self.driven.refuse(error))?;
        Ok(Solved {
            pose,
            velocities,
            accelerations,
        })
    }

    fn answer(&self, robot: &Robot) -> Result<MotionAnswer, Refusal> {
        let Solved {
            pose,
            velocities,
            accelerations,
        } = self.solve(robot)?;
        let [_, omega2, omega3, _] = velocities.omega;
        let [_, alpha2, alpha3, _] = accelerations.alpha;
        Ok(MotionAnswer {
            c: array(pose.c),
            c_velocity: array(velocities.c),
            c_acceleration: array(accelerations.c),
            omega2,
            omega3,
            alpha2,
            alpha3,
        })
    }
}

impl InverseDynamics {
    fn answer(&self, robot: &Robot) -> Result<InverseDynamicsAnswer, Refusal> {
        let arm = masses(robot)?;
        let Solved {
            pose,
            velocities,
            accelerations,
        } = self.motion.solve(robot)?;
        let force = vec2(self.external_force);
        let refuse = |error| self.motion.driven.refuse(error);
        let torque = arm
            .inverse_dynamics(&pose, &velocities, &accelerations, force)
            .map_err(refuse)?;
        let mass = arm.mass_matrix(&pose).map_err(refuse)?;
        let bias_torque = arm
            .nonlinear_effects(&pose, &velocities, force)
            .map_err(refuse)?;
        let reactions = arm
            .reactions(&pose, &velocities, &accelerations, force)
            .map_err(refuse)?;
        Ok(InverseDynamicsAnswer {
            torque,
            mass_matrix: [[mass.m11, mass.m12], [mass.m21, mass.m22]],
            bias_torque,
            reaction: Reaction {
                a: array(reactions.a),
                b: array(reactions.b),
                c: array(reactions.c),
                d: array(reactions.d),
                e: array(reactions.e),
            },
        })
    }
}

impl ForwardDynamics {
    fn answer(&self, robot: &Robot) -> Result<ForwardDynamicsAnswer, Refusal> {
        let arm = masses(robot)?;
        let pose = self.driven.pose(robot)?;
        let refuse = |error| self.driven.refuse(error);
        let velocities = robot
            .geometry
            .forward_velocities(&pose, self.omega1, self.omega4)
            .map_err(refuse)?;
        let [alpha1, alpha4] = arm
            .forward_dynamics(&pose, &velocities, self.torque, vec2(self.external_force))
            .map_err(refuse)?;
        Ok(ForwardDynamicsAnswer { alpha1, alpha4 })
    }
}

fn masses(robot: &Robot) -> Result<&Arm<f64>, Refusal> {
    robot.arm().map_err(Refusal::invalid)
}

impl From<PoseError> for Kind {
    fn from(error: PoseError) -> Self {
        match error {
            PoseError::Unreachable(_) => Self::Unreachable,
            PoseError::Singular(_) => Self::Singular,
            PoseError::NotFinite => Self::Invalid,
        }
    }
}

fn refusal(error: PoseError, place: &str) -> Refusal {
    Refusal {
        error: error.into(),
        message: format!("{error}, {place}"),
    }
}

fn vec2([x, y]: [f64; 2]) -> Vector2<f64> {
    Vector2::new(x, y)
}

fn array(v: Vector2<f64>) -> [f64; 2] {
    [v.x, v.y]
}
