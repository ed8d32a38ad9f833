//! The analysis at one state of the arm: first-order scatter, exact worst cases, seated pins.

use super::{
    ClearanceError, ToolSensitivities, clearance_error, tool_sensitivities, worst_input_error,
};
use crate::accuracy::arm::{ArmAccuracyModel, DrivenJointMotion, PRIMITIVES};
use crate::accuracy::clearance_equilibrium::{ClearanceEquilibrium, clearance_equilibrium};
use crate::accuracy::{AnalysisError, Primitive, Scatter, sensitivities};
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{Geometry, Pose, WorkingMode};
use nalgebra::{DMatrix, Vector2};

/// The tolerances of an arm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmTolerance {
    /// Standard deviation of l1…l4 and the base [m].
    pub length_sd: [f64; 5],
    /// Standard deviation of θ1 and θ4 [rad].
    pub input_sd: [f64; 2],
    /// Greatest error of θ1 and θ4 [rad].
    pub input_max: [f64; 2],
    /// Radial clearance of the joints A, B, C, D, E [m].
    pub clearance_radius: [f64; 5],
}

/// An arm with its tolerances, in one working mode.
#[derive(Clone, Copy, Debug)]
pub struct TolerancedArm<'a> {
    /// Its nominal lengths.
    pub geometry: &'a Geometry<f64>,
    /// Its masses, with the same lengths; none if only lengths are known.
    pub arm: Option<&'a Arm<f64>>,
    /// The sides to which the elbows of the legs A–B–C and E–D–C turn.
    pub working_mode: WorkingMode,
    /// Its tolerances.
    pub tolerance: &'a ArmTolerance,
}

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

impl ToolState {
    /// C at rest at `position` [m], without a force.
    pub fn at_rest(position: Vector2<f64>) -> Self {
        Self {
            position,
            velocity: Vector2::zeros(),
            acceleration: Vector2::zeros(),
            force: Vector2::zeros(),
        }
    }
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
    pub forces: Option<ForceAnalysis>,
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
pub struct ForceAnalysis {
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

/// Analyses one state of an arm.
///
/// ```
/// use fivebar_design::accuracy::five_bar::{ArmTolerance, ToolState, TolerancedArm, analyse};
/// use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
/// use nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10, 0.16, 0.16, 0.10, 0.08])?; // m
/// let tolerance = ArmTolerance { length_sd: [20e-6; 5], ..ArmTolerance::default() }; // m
/// let arm = TolerancedArm {
///     geometry: &geometry,
///     arm: None,
///     working_mode: WorkingMode::new(Side::Left, Side::Right),
///     tolerance: &tolerance,
/// };
/// let analysis = analyse(&arm, &ToolState::at_rest(Vector2::new(0.04, 0.2)))?;
/// // Lengths of ±20 µm displace the tool by some tens of micrometres.
/// assert!((20e-6..200e-6).contains(&analysis.radial_deviation()));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
///
/// # Errors
/// The reason why the arm cannot be in this state.
pub fn analyse(
    arm: &TolerancedArm<'_>,
    state: &ToolState,
) -> Result<AccuracyAnalysis, AnalysisError> {
    let geometry = arm.geometry;
    let pose = geometry.inverse(state.position, arm.working_mode)?;
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
    let primitives = primitives(arm, &inputs);
    let by = tool_sensitivities(geometry, &pose)?;
    let tolerance = arm.tolerance;
    let forces = match arm.arm {
        None => None,
        Some(arm) => {
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
            Some(ForceAnalysis {
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

fn primitives(arm: &TolerancedArm<'_>, inputs: &DrivenJointMotion) -> Vec<Primitive> {
    let ArmTolerance {
        length_sd,
        input_sd,
        ..
    } = *arm.tolerance;
    let means = inputs.theta.into_iter().chain(arm.geometry.lengths());
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
