//! Queries about a five-bar: positions, motion and dynamics, forward and inverse.

use super::{QueryError, QueryErrorKind};
use fivebar_files::robot::Robot;
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{Accelerations, Pose, PoseError, Side, Velocities, WorkingMode};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// The keys of queries and of their answers, so that a reference state, which has both and the number of its robot, can be
/// asked as it is.
pub const KEYS: [&str; 25] = [
    "op",
    "robot",
    "theta1",
    "theta4",
    "omega1",
    "omega4",
    "alpha1",
    "alpha4",
    "assembly",
    "elbow1",
    "elbow4",
    "external_force",
    "torque",
    "c",
    "c_velocity",
    "c_acceleration",
    "theta2",
    "theta3",
    "omega2",
    "omega3",
    "alpha2",
    "alpha3",
    "mass_matrix",
    "bias_torque",
    "reaction",
];

/// A query. SI units, absolute angles; C is the point where links 2 and 3 meet.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(tag = "op", rename_all = "snake_case")]
pub enum Query {
    /// The position of C from the driven angles.
    Forward(ForwardQuery),
    /// The driven angles from the position of C.
    Inverse(InverseQuery),
    /// Velocities and accelerations of the links and of C.
    Motion(MotionQuery),
    /// The torques that a motion needs.
    InverseDynamics(InverseDynamicsQuery),
    /// The accelerations that torques give.
    ForwardDynamics(ForwardDynamicsQuery),
}

/// The driven angles [rad] and the assembly mode.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct ForwardQuery {
    theta1: f64,
    theta4: f64,
    assembly: Side,
}

/// C [m] and the working mode.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct InverseQuery {
    c: [f64; 2],
    elbow1: Side,
    elbow4: Side,
}

/// The driven joints' angles, rates [rad/s] and accelerations [rad/s²].
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct MotionQuery {
    #[serde(flatten)]
    driven: ForwardQuery,
    omega1: f64,
    omega4: f64,
    alpha1: f64,
    alpha4: f64,
}

/// A motion with a force [N] on C.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct InverseDynamicsQuery {
    #[serde(flatten)]
    motion: MotionQuery,
    external_force: [f64; 2],
}

/// Angles and rates with torques [N·m] on links 1 and 4, and a force [N] on C.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct ForwardDynamicsQuery {
    #[serde(flatten)]
    driven: ForwardQuery,
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

/// The answer to a query about a robot.
///
/// # Errors
/// The reason if there is no answer.
pub fn answer(robot: &Robot, query: Query) -> Result<Value, QueryError> {
    match query {
        Query::Forward(driven) => driven.answer(robot).map(|answer| json!(answer)),
        Query::Inverse(inverse) => inverse.answer(robot).map(|answer| json!(answer)),
        Query::Motion(motion) => motion.answer(robot).map(|answer| json!(answer)),
        Query::InverseDynamics(dynamics) => dynamics.answer(robot).map(|answer| json!(answer)),
        Query::ForwardDynamics(dynamics) => dynamics.answer(robot).map(|answer| json!(answer)),
    }
}

impl ForwardQuery {
    fn pose(&self, robot: &Robot) -> Result<Pose<f64>, QueryError> {
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

    fn refuse(&self, error: PoseError) -> QueryError {
        let Self { theta1, theta4, .. } = self;
        refusal(
            error,
            &format!("at θ1 = {theta1:?} rad, θ4 = {theta4:?} rad"),
        )
    }

    fn answer(&self, robot: &Robot) -> Result<ForwardAnswer, QueryError> {
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

impl InverseQuery {
    fn answer(&self, robot: &Robot) -> Result<InverseAnswer, QueryError> {
        let [x, y] = self.c;
        let mode = WorkingMode::new(self.elbow1, self.elbow4);
        let pose = robot
            .geometry
            .inverse(Vector2::from(self.c), mode)
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

/// The solution of a motion.
struct Solved {
    pose: Pose<f64>,
    velocities: Velocities<f64>,
    accelerations: Accelerations<f64>,
}

impl MotionQuery {
    fn solve(&self, robot: &Robot) -> Result<Solved, QueryError> {
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

    fn answer(&self, robot: &Robot) -> Result<MotionAnswer, QueryError> {
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

impl InverseDynamicsQuery {
    fn answer(&self, robot: &Robot) -> Result<InverseDynamicsAnswer, QueryError> {
        let arm = masses(robot)?;
        let Solved {
            pose,
            velocities,
            accelerations,
        } = self.motion.solve(robot)?;
        let force = Vector2::from(self.external_force);
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

impl ForwardDynamicsQuery {
    fn answer(&self, robot: &Robot) -> Result<ForwardDynamicsAnswer, QueryError> {
        let arm = masses(robot)?;
        let pose = self.driven.pose(robot)?;
        let refuse = |error| self.driven.refuse(error);
        let velocities = robot
            .geometry
            .forward_velocities(&pose, self.omega1, self.omega4)
            .map_err(refuse)?;
        let [alpha1, alpha4] = arm
            .forward_dynamics(
                &pose,
                &velocities,
                self.torque,
                Vector2::from(self.external_force),
            )
            .map_err(refuse)?;
        Ok(ForwardDynamicsAnswer { alpha1, alpha4 })
    }
}

fn masses(robot: &Robot) -> Result<&Arm<f64>, QueryError> {
    robot.arm().map_err(QueryError::invalid)
}

impl From<PoseError> for QueryErrorKind {
    fn from(error: PoseError) -> Self {
        match error {
            PoseError::Unreachable(_) => Self::Unreachable,
            PoseError::Singular(_) => Self::Singular,
            PoseError::NotFinite => Self::Invalid,
        }
    }
}

fn refusal(error: PoseError, place: &str) -> QueryError {
    QueryError {
        error: error.into(),
        message: format!("{error}, {place}"),
    }
}

fn array(v: Vector2<f64>) -> [f64; 2] {
    [v.x, v.y]
}
