//! Calibration of a robot from touched holes, and the poses proposed for it.

mod answer;

pub use answer::{answer, proposal_answer, warnings};

use crate::input::robot::{HomeError, Measured, MeasuredKey, Robot, WorkspaceError};
use fivebar_design::calibration::{
    Calibration, CalibrationError, Plate, Proposal, TipError, Touch, calibrate, propose, tip_error,
};
use fivebar_kinematics::five_bar::{Geometry, GeometryError, Tool, Workspace};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// Why a robot cannot be calibrated, or poses not be proposed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// Without actuators there are no counts.
    #[error("robot `{0}` has no [[actuator]]: counts need gear_ratio and encoder_counts")]
    NoActuators(String),
    /// The assembly mode is not known.
    #[error(transparent)]
    Home(#[from] HomeError),
    /// The points are refused.
    #[error(transparent)]
    Points(#[from] CalibrationError),
    /// The workspace is not valid.
    #[error(transparent)]
    Workspace(#[from] WorkspaceError),
    /// The lengths do not make an arm.
    #[error(transparent)]
    Lengths(#[from] GeometryError),
    /// The arm reaches too few places.
    #[error(
        "robot `{0}` reaches fewer than {1} places of a grid within its limits.angle and \
         singularity_margin, so no {1} poses can be proposed"
    )]
    NoPlaces(String, usize),
}

/// A calibrated robot.
#[derive(Debug)]
pub struct CalibrationStudy {
    /// The result.
    pub calibration: Calibration,
    /// The expected error of the tip over the workspace.
    pub tip_error: Option<TipError>,
    /// σ of the holes [m].
    pub sigma: f64,
}

/// Calibrates a robot from rows of counts1, counts4, x, y.
///
/// # Errors
/// The robot has no counts or no pose at home, or the points are refused.
pub fn calibrate_robot(
    robot: &Robot,
    rows: &[[f64; 4]],
    sigma: f64,
    huber: bool,
) -> Result<CalibrationStudy, StudyError> {
    let per_turn = counts_per_turn(robot)?;
    let angle = |count: f64, per_turn: f64| (count + 0.5) * TAU / per_turn;
    let touch = |&[counts1, counts4, x, y]: &[f64; 4]| Touch {
        encoder: [angle(counts1, per_turn[0]), angle(counts4, per_turn[1])],
        hole: Vector2::new(x, y),
    };
    let home = robot.home_pose()?;
    let plate = Plate {
        touches: rows.iter().map(touch).collect(),
        assembly: home.assembly(),
        sigma,
        huber,
    };
    let calibration = calibrate(&plate, robot.geometry.lengths())?;
    let workspace = bare_workspace(robot, calibration.parameters.lengths)?;
    let tip_error = tip_error(
        &calibration.parameters,
        &calibration.covariance,
        &workspace,
        &home,
    );
    Ok(CalibrationStudy {
        calibration,
        tip_error,
        sigma,
    })
}

/// Encoder counts per turn of joint 1 and of joint 4; negative where the motor turns against its
/// joint.
fn counts_per_turn(robot: &Robot) -> Result<[f64; 2], StudyError> {
    let actuators = robot.actuators.as_ref();
    let actuators = actuators.ok_or_else(|| StudyError::NoActuators(robot.name.clone()))?;
    Ok(actuators
        .each_ref()
        .map(|actuator| f64::from(actuator.encoder_counts) * actuator.gear_ratio))
}

/// The workspace of C with these lengths [m], in the file's working mode.
fn bare_workspace(robot: &Robot, lengths: [f64; 5]) -> Result<Workspace<f64>, StudyError> {
    let mut workspace = robot.workspace(robot.elbows)?;
    workspace.tool = Tool::new(Geometry::new(lengths)?, Vector2::zeros())?;
    Ok(workspace)
}

/// Proposed poses.
#[derive(Debug)]
pub struct ProposalStudy {
    /// The poses.
    pub proposal: Proposal,
    /// The error of the tip to be expected with them.
    pub tip_error: Option<TipError>,
    /// σ of the holes [m].
    pub sigma: f64,
}

/// The best poses for the calibration of a robot.
///
/// # Errors
/// The robot has no pose at home, or reaches too few places.
pub fn propose_poses(robot: &Robot, count: usize, sigma: f64) -> Result<ProposalStudy, StudyError> {
    let workspace = bare_workspace(robot, robot.geometry.lengths())?;
    let home = robot.home_pose()?;
    let proposal = propose(&workspace, &home, count)
        .ok_or_else(|| StudyError::NoPlaces(robot.name.clone(), count))?;
    let nominal = fivebar_design::calibration::Parameters {
        lengths: robot.geometry.lengths(),
        ..Default::default()
    };
    let covariance = proposal.covariance * (sigma * sigma);
    let tip_error = tip_error(&nominal, &covariance, &workspace, &home);
    Ok(ProposalStudy {
        proposal,
        tip_error,
        sigma,
    })
}

/// The values of the robot file that follow from a calibration: lengths, base, and the angles at
/// the home switches, which take up the joint offsets.
pub fn measured(robot: &Robot, study: &CalibrationStudy) -> Vec<Measured> {
    let p = &study.calibration.parameters;
    let sd = |index: usize| study.calibration.covariance[(index, index)].sqrt();
    let length = |key, index: usize| Measured {
        key,
        value: format!("{:.9}", p.lengths[index]),
        origin: format!("± {} by calibration", micrometres(sd(index))),
    };
    let mut values: Vec<Measured> = (0..4)
        .map(|link| length(MeasuredKey::Link(link, "length"), link))
        .collect();
    values.push(length(MeasuredKey::Base, 4));
    let [home1, home4] = robot.home;
    values.push(Measured {
        key: MeasuredKey::Home,
        value: format!("[{:.9}, {:.9}]", home1 + p.offsets[0], home4 + p.offsets[1]),
        origin: format!(
            "± {:.0} and ± {:.0} µrad by calibration",
            1e6 * sd(5),
            1e6 * sd(6)
        ),
    });
    values
}

/// A length as text.
fn micrometres(metres: f64) -> String {
    format!("{:.1} µm", 1e6 * metres)
}
