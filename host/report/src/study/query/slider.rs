//! Queries about a slider-driven mechanism: positions and motion, forward and inverse, error
//! transfer, reach.

use super::{QueryError, QueryErrorKind};
use fivebar_design::linkage::dyad::SlideBranch;
use fivebar_design::slider::{Accelerations, Pose, PoseError, Velocities, WorkingMode};
use fivebar_files::robot::SliderRobot;
use fivebar_kinematics::five_bar::Side;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// The keys of queries and of the answers about positions and motion, so that an answer can be asked again.
pub const KEYS: [&str; 20] = [
    "op",
    "x2",
    "x8",
    "assembly",
    "p",
    "left",
    "right",
    "x2_velocity",
    "x8_velocity",
    "x2_acceleration",
    "x8_acceleration",
    "p_velocity",
    "p_acceleration",
    "y",
    "alpha3",
    "alpha7",
    "alpha3_rate",
    "alpha7_rate",
    "alpha3_acceleration",
    "alpha7_acceleration",
];

/// A query. SI units; P is the middle of the platform.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(tag = "op", rename_all = "snake_case")]
pub enum Query {
    /// The position of P from those of the sliders.
    Forward(ForwardQuery),
    /// The positions of the sliders from that of P.
    Inverse(InverseQuery),
    /// Velocities and accelerations from those of the sliders.
    Motion(MotionQuery),
    /// Velocities and accelerations from those of P.
    InverseMotion(InverseMotionQuery),
    /// The displacement of P per error of each length and input.
    ErrorTransfer(ForwardQuery),
    /// The range of P along the guide at a height, within the sliders' travel.
    Reach(ReachQuery),
}

/// The sliders' positions [m] and the assembly mode: `left` above the guide, `right` below.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct ForwardQuery {
    x2: f64,
    x8: f64,
    assembly: Side,
}

/// P [m] and the working mode; by default the file's.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct InverseQuery {
    p: [f64; 2],
    left: Option<SlideBranch>,
    right: Option<SlideBranch>,
}

/// The sliders' positions [m], velocities [m/s] and accelerations [m/s²].
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct MotionQuery {
    #[serde(flatten)]
    driven: ForwardQuery,
    x2_velocity: f64,
    x8_velocity: f64,
    x2_acceleration: f64,
    x8_acceleration: f64,
}

/// P's position [m], velocity [m/s] and acceleration [m/s²].
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct InverseMotionQuery {
    #[serde(flatten)]
    position: InverseQuery,
    p_velocity: [f64; 2],
    p_acceleration: [f64; 2],
}

/// A height of P [m] and the working mode; by default the file's.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct ReachQuery {
    y: f64,
    left: Option<SlideBranch>,
    right: Option<SlideBranch>,
}

#[derive(Serialize)]
struct ForwardAnswer {
    p: [f64; 2],
    alpha3: f64,
    alpha7: f64,
    left: SlideBranch,
    right: SlideBranch,
}

#[derive(Serialize)]
struct InverseAnswer {
    x2: f64,
    x8: f64,
    alpha3: f64,
    alpha7: f64,
    assembly: Side,
}

#[derive(Serialize)]
struct MotionAnswer {
    p: [f64; 2],
    p_velocity: [f64; 2],
    p_acceleration: [f64; 2],
    x2: f64,
    x8: f64,
    x2_velocity: f64,
    x8_velocity: f64,
    x2_acceleration: f64,
    x8_acceleration: f64,
    alpha3_rate: f64,
    alpha7_rate: f64,
    alpha3_acceleration: f64,
    alpha7_acceleration: f64,
}

/// ∂P/∂ each length and input [m/m].
#[derive(Serialize)]
struct ErrorTransferAnswer {
    left_link: [f64; 2],
    right_link: [f64; 2],
    platform: [f64; 2],
    x2: [f64; 2],
    x8: [f64; 2],
}

/// The answer to a query about a mechanism.
///
/// # Errors
/// The reason if there is no answer.
pub fn answer(robot: &SliderRobot, query: Query) -> Result<Value, QueryError> {
    match query {
        Query::Forward(driven) => {
            let pose = driven.pose(robot)?;
            let [alpha3, alpha7] = pose.angles();
            let WorkingMode { left, right } = pose.working_mode();
            Ok(json!(ForwardAnswer {
                p: array(pose.p),
                alpha3,
                alpha7,
                left,
                right,
            }))
        }
        Query::Inverse(inverse) => {
            let pose = inverse.pose(robot)?;
            let [alpha3, alpha7] = pose.angles();
            Ok(json!(InverseAnswer {
                x2: pose.x2,
                x8: pose.x8,
                alpha3,
                alpha7,
                assembly: pose.assembly(),
            }))
        }
        Query::Motion(motion) => motion.answer(robot),
        Query::InverseMotion(motion) => motion.answer(robot),
        Query::ErrorTransfer(driven) => {
            let pose = driven.pose(robot)?;
            let transfer = robot.geometry.error_transfer(&pose);
            let transfer = transfer.map_err(|error| driven.refuse(error))?;
            Ok(json!(ErrorTransferAnswer {
                left_link: array(transfer.l3),
                right_link: array(transfer.l7),
                platform: array(transfer.l5),
                x2: array(transfer.x2),
                x8: array(transfer.x8),
            }))
        }
        Query::Reach(reach) => reach.answer(robot),
    }
}

impl ForwardQuery {
    fn pose(&self, robot: &SliderRobot) -> Result<Pose<f64>, QueryError> {
        robot
            .geometry
            .forward(self.x2, self.x8, self.assembly)
            .map_err(|error| self.refuse(error))
    }

    fn refuse(&self, error: PoseError) -> QueryError {
        let Self { x2, x8, .. } = self;
        refusal(error, &format!("at x2 = {x2} m, x8 = {x8} m"))
    }
}

impl InverseQuery {
    fn pose(&self, robot: &SliderRobot) -> Result<Pose<f64>, QueryError> {
        let mode = mode(robot, self.left, self.right);
        robot
            .geometry
            .inverse(Vector2::from(self.p), mode)
            .map_err(|error| self.refuse(error))
    }

    fn refuse(&self, error: PoseError) -> QueryError {
        let [x, y] = self.p;
        refusal(error, &format!("with P at ({x}, {y}) m"))
    }
}

impl MotionQuery {
    fn answer(&self, robot: &SliderRobot) -> Result<Value, QueryError> {
        let pose = self.driven.pose(robot)?;
        let refuse = |error| self.driven.refuse(error);
        let rates = [self.x2_velocity, self.x8_velocity];
        let velocities = robot.geometry.forward_velocities(&pose, rates);
        let velocities = velocities.map_err(refuse)?;
        let second = [self.x2_acceleration, self.x8_acceleration];
        let accelerations = robot
            .geometry
            .forward_accelerations(&pose, &velocities, second)
            .map_err(refuse)?;
        Ok(motion_answer(&pose, &velocities, &accelerations))
    }
}

impl InverseMotionQuery {
    fn answer(&self, robot: &SliderRobot) -> Result<Value, QueryError> {
        let pose = self.position.pose(robot)?;
        let refuse = |error| self.position.refuse(error);
        let velocities = robot
            .geometry
            .inverse_velocities(&pose, Vector2::from(self.p_velocity))
            .map_err(refuse)?;
        let accelerations = robot
            .geometry
            .inverse_accelerations(&pose, &velocities, Vector2::from(self.p_acceleration))
            .map_err(refuse)?;
        Ok(motion_answer(&pose, &velocities, &accelerations))
    }
}

impl ReachQuery {
    fn answer(&self, robot: &SliderRobot) -> Result<Value, QueryError> {
        let travel = robot.travel.as_ref().ok_or_else(|| {
            let name = &robot.name;
            QueryError::invalid(format!(
                "the file of `{name}` has no [travel]; add it to compute the reach"
            ))
        })?;
        let y = self.y;
        let [least, greatest] = robot
            .geometry
            .reachable_at(y, mode(robot, self.left, self.right), travel)
            .map_err(|error| refusal(error, &format!("at y = {y} m")))?;
        Ok(json!({ "x": [least, greatest] }))
    }
}

fn mode(robot: &SliderRobot, left: Option<SlideBranch>, right: Option<SlideBranch>) -> WorkingMode {
    let own = robot.working_mode;
    WorkingMode::new(left.unwrap_or(own.left), right.unwrap_or(own.right))
}

fn motion_answer(
    pose: &Pose<f64>,
    velocities: &Velocities<f64>,
    accelerations: &Accelerations<f64>,
) -> Value {
    let [x2_velocity, x8_velocity] = velocities.sliders;
    let [x2_acceleration, x8_acceleration] = accelerations.sliders;
    let [alpha3_rate, alpha7_rate] = velocities.omega;
    let [alpha3_acceleration, alpha7_acceleration] = accelerations.alpha;
    json!(MotionAnswer {
        p: array(pose.p),
        p_velocity: array(velocities.p),
        p_acceleration: array(accelerations.p),
        x2: pose.x2,
        x8: pose.x8,
        x2_velocity,
        x8_velocity,
        x2_acceleration,
        x8_acceleration,
        alpha3_rate,
        alpha7_rate,
        alpha3_acceleration,
        alpha7_acceleration,
    })
}

fn refusal(error: PoseError, place: &str) -> QueryError {
    let kind = match error {
        PoseError::LimbPerpendicular(_) | PoseError::Parallel => QueryErrorKind::Singular,
        PoseError::NotFinite => QueryErrorKind::Invalid,
        PoseError::LimbTooShort(_)
        | PoseError::SlidersTooFar
        | PoseError::SlidersTooNear
        | PoseError::BeyondTravel => QueryErrorKind::Unreachable,
    };
    QueryError {
        error: kind,
        message: format!("{error}, {place}"),
    }
}

fn array(v: Vector2<f64>) -> [f64; 2] {
    [v.x, v.y]
}
