//! The analysis at one state of the arm: first-order scatter, exact worst cases, seated pins.

use super::error::{AccuracyStudyError, PlaceError};
use crate::input::robot::{Robot, Tolerance};
use fivebar_design::accuracy::arm::{ArmAccuracyModel, DrivenJointMotion, PRIMITIVES};
use fivebar_design::accuracy::clearance_equilibrium::{
    ClearanceEquilibrium, clearance_equilibrium,
};
use fivebar_design::accuracy::five_bar::{
    ClearanceError, ToolSensitivities, clearance_error, tool_sensitivities, worst_input_error,
};
use fivebar_design::accuracy::{Primitive, Scatter, sensitivities};
use fivebar_kinematics::five_bar::Pose;
use nalgebra::DMatrix;
use nalgebra::Vector2;

/// Position and motion of C, and the force on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolState {
    /// C [m].
    pub position: Vector2<f64>,
    /// Ċ [m/s].
    pub velocity: Vector2<f64>,
    /// C̈ [m/s²].
    pub acceleration: Vector2<f64>,
    /// A force on C [N].
    pub force: Vector2<f64>,
}

/// The effect of tolerances and clearances at one state of the arm.
#[derive(Clone, Debug)]
pub struct AccuracyAnalysis {
    /// The pose.
    pub pose: Pose<f64>,
    /// The driven joints' motion.
    pub inputs: DrivenJointMotion,
    /// θ1, θ4, l1…l4 and the base with their scatter.
    pub primitives: Vec<Primitive>,
    /// Displacement of C per error of each of them, from the middle of the base.
    pub sensitivities: ToolSensitivities,
    /// The scatter of C, from the middle of the base [m²].
    pub position: Scatter,
    /// Greatest displacement of C by errors of the inputs [m].
    pub input_worst: f64,
    /// Displacement of C by clearances.
    pub clearance: ClearanceError,
    /// The part that needs masses; none for a robot with lengths only.
    pub forces: Option<Forces>,
}

impl AccuracyAnalysis {
    /// √(σx² + σy²) of C [m].
    pub fn radial_deviation(&self) -> f64 {
        self.position.covariance.trace().sqrt()
    }

    /// |∂C/∂p|² for each primitive, in its unit.
    pub fn weights(&self) -> Vec<f64> {
        let columns = self
            .sensitivities
            .inputs
            .iter()
            .chain(&self.sensitivities.lengths);
        columns.map(nalgebra::Matrix::norm_squared).collect()
    }
}

/// Scatter of torques and joint forces, and the clearance equilibrium.
#[derive(Clone, Debug)]
pub struct Forces {
    /// Scatter of Ċ [m/s] and C̈ [m/s²], x and y, with the driven joints on their references.
    pub motion: Scatter,
    /// Scatter of τ1, τ4 [N·m] and of the forces in A, B, C, D, E, x and y [N].
    pub scatter: Scatter,
    /// The clearance equilibrium under these forces.
    pub equilibrium: ClearanceEquilibrium,
}

/// The primitives with a scatter, inputs and lengths, by their columns among those of
/// [`ArmAccuracyModel`].
pub(super) const SCATTERED: [usize; 7] = [0, 1, 6, 7, 8, 9, 10];

/// Analyses one state of a robot.
///
/// # Errors
/// `Place` with the reason why the arm cannot be in this state.
pub fn analyse(robot: &Robot, state: &ToolState) -> Result<AccuracyAnalysis, AccuracyStudyError> {
    analyse_state(robot, state).map_err(|reason| AccuracyStudyError::Place {
        place: state.position.into(),
        reason,
    })
}

fn analyse_state(robot: &Robot, state: &ToolState) -> Result<AccuracyAnalysis, PlaceError> {
    let geometry = &robot.geometry;
    let pose = geometry.inverse(state.position, robot.elbows)?;
    let rates = geometry.inverse_velocities(&pose, state.velocity)?;
    let accelerations = geometry.inverse_accelerations(&pose, &rates, state.acceleration)?;
    let [theta1, _, _, theta4] = pose.angles();
    let [omega1, _, _, omega4] = rates.omega;
    let [alpha1, _, _, alpha4] = accelerations.alpha;
    let inputs = DrivenJointMotion {
        theta: [theta1, theta4],
        omega: [omega1, omega4],
        alpha: [alpha1, alpha4],
    };
    let primitives = primitives(robot, &inputs);
    let by = tool_sensitivities(geometry, &pose)?;
    let tolerance = &robot.tolerance;
    let forces = match robot.arm() {
        Err(_) => None,
        Ok(arm) => {
            let model = ArmAccuracyModel {
                arm,
                assembly: pose.assembly(),
                external_force: state.force,
            };
            let all = sensitivities(&model, &model.primitives(&inputs))?;
            let scattered = all.select_columns(&SCATTERED);
            let propagate = |first: usize, count: usize| {
                Scatter::propagate(&scattered.rows(first, count).into_owned(), &primitives)
            };
            let equilibrium = clearance_equilibrium(
                arm,
                pose.assembly(),
                &inputs,
                state.force,
                tolerance.clearance_radius,
            )?;
            Some(Forces {
                motion: propagate(2, 4),
                scatter: propagate(6, 12),
                equilibrium,
            })
        }
    };
    Ok(AccuracyAnalysis {
        position: Scatter::propagate(&columns(&by), &primitives),
        sensitivities: by,
        input_worst: worst_input_error(geometry, &pose, tolerance.input_max)?,
        clearance: clearance_error(geometry, &pose, tolerance.clearance_radius)?,
        pose,
        inputs,
        primitives,
        forces,
    })
}

fn primitives(robot: &Robot, inputs: &DrivenJointMotion) -> Vec<Primitive> {
    let Tolerance {
        length_sd,
        input_sd,
        ..
    } = robot.tolerance;
    let means = inputs.theta.into_iter().chain(robot.geometry.lengths());
    let deviations = input_sd.into_iter().chain(length_sd);
    let names = SCATTERED.map(|index| PRIMITIVES[index]);
    names
        .into_iter()
        .zip(means.zip(deviations))
        .map(|(name, (mean, deviation))| Primitive {
            name: name.into(),
            mean,
            deviation,
        })
        .collect()
}

fn columns(by: &ToolSensitivities) -> DMatrix<f64> {
    let columns: Vec<&Vector2<f64>> = by.inputs.iter().chain(&by.lengths).collect();
    DMatrix::from_fn(2, columns.len(), |row, column| {
        [columns[column].x, columns[column].y][row]
    })
}
