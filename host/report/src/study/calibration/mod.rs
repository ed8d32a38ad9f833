//! Calibration of a robot from touched holes, and the poses proposed for it.

mod answer;
mod mixed;

pub use answer::{answer, proposal_answer, warnings};
pub use mixed::{MixedStudy, Rows, calibrate_robot_mixed, mixed_answer, mixed_warnings};

use fivebar_design::calibration::{
    Calibration, CalibrationError, Criterion, Parameters, Plate, Proposal, TipError, Touch,
    Unknowns, calibrate, propose, tip_error, tip_error_before,
};
use fivebar_files::robot::{HomeError, Measured, MeasuredKey, Robot, WorkspaceError};
use fivebar_kinematics::five_bar::{Geometry, GeometryError, Joint, Tool, Workspace};
use nalgebra::{SMatrix, Vector2};
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
    /// A hole's number is no whole number: its row from 1, and the number.
    #[error("row {0} of the holes: `hole` must be a whole number, not {1}")]
    HoleNumber(usize, f64),
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
    /// The error of the nominal arm over the workspace, after its best placement.
    pub before: Option<TipError>,
    /// The expected error of the tip over the workspace.
    pub tip_error: Option<TipError>,
    /// σ of the holes as stated [m].
    pub sigma: f64,
    /// What was made least.
    pub criterion: Criterion,
}

/// Calibrates a robot from rows of counts1, counts4, x, y.
///
/// # Errors
/// The robot has no counts or no pose at home, or the points are refused.
pub fn calibrate_robot(
    robot: &Robot,
    rows: &[[f64; 4]],
    sigma: f64,
    criterion: Criterion,
) -> Result<CalibrationStudy, StudyError> {
    let per_turn = counts_per_turn(robot)?;
    let touch = |&[counts1, counts4, x, y]: &[f64; 4]| Touch {
        encoder: [
            encoder_angle(counts1, per_turn[0]),
            encoder_angle(counts4, per_turn[1]),
        ],
        hole: Vector2::new(x, y),
    };
    let home = robot.home_pose()?;
    let plate = Plate {
        touches: rows.iter().map(touch).collect(),
        assembly: home.assembly(),
        sigma,
        criterion,
    };
    let calibration = calibrate(&plate, robot.geometry.lengths())?;
    let workspace = bare_workspace(robot, calibration.parameters.lengths)?;
    let tip_error = tip_error(
        &calibration.parameters,
        &calibration.covariance,
        &workspace,
        &home,
    );
    let drawn = bare_workspace(robot, robot.geometry.lengths())?;
    Ok(CalibrationStudy {
        before: tip_error_before(&calibration.parameters, &drawn, &home),
        calibration,
        tip_error,
        sigma,
        criterion,
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

/// The middle of a count [rad].
fn encoder_angle(count: f64, per_turn: f64) -> f64 {
    (count + 0.5) * TAU / per_turn
}

/// The counts of both encoders at these angles of the joints [rad], as the robot's file has its zeros.
pub(super) fn encoder_count(robot: &Robot, angles: [f64; 2]) -> Result<[f64; 2], StudyError> {
    let per_turn = counts_per_turn(robot)?;
    Ok([0, 1].map(|joint| angles[joint] * per_turn[joint] / TAU - 0.5))
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
    let nominal = Parameters {
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

/// The values of the robot file that follow from a calibration: lengths, the base unless it is 0, and the angles at
/// the home switches, which take up the joint offsets; of servos also those at the middle of their widths.
pub fn measured(robot: &Robot, p: &Parameters, covariance: &SMatrix<f64, 10, 10>) -> Vec<Measured> {
    let sd = |index: usize| covariance[(index, index)].sqrt();
    let length = |key, index: usize| Measured {
        key,
        value: format!("{:.9}", p.lengths[index]),
        origin: format!("± {} by calibration", micrometres(sd(index))),
    };
    let mut values: Vec<Measured> = (0..4)
        .map(|link| length(MeasuredKey::Link(link, "length"), link))
        .collect();
    let unknowns = Unknowns::of(robot.geometry.lengths());
    if unknowns.is_free(4) {
        values.push(length(MeasuredKey::Base, 4));
    }
    let angle = |index: usize| match sd(index) {
        0.0 => "held".into(),
        sd => format!("± {:.0}", 1e6 * sd),
    };
    let [home1, home4] = robot.home;
    values.push(Measured {
        key: MeasuredKey::Home,
        value: format!("[{:.9}, {:.9}]", home1 + p.offsets[0], home4 + p.offsets[1]),
        origin: format!("{} and {} µrad by calibration", angle(5), angle(6)),
    });
    // A servo's angle follows from its pulse: what is an offset of home is one of every width.
    let middles = robot.middle_angles().into_iter();
    let middles = middles.flat_map(|middles| Joint::ALL.map(|joint| (joint, middles[joint])));
    values.extend(middles.map(|(joint, middle)| Measured {
        key: MeasuredKey::Actuator(joint, "middle_angle"),
        value: format!("{:.9}", middle + p.offsets[joint]),
        origin: format!("± {:.0} µrad by calibration", 1e6 * sd(5 + joint.index())),
    }));
    values
}

/// Degrees of freedom; none where they are infinite.
fn known(freedom: f64) -> Option<f64> {
    freedom.is_finite().then_some(freedom)
}

/// That measurements scatter otherwise than stated, as a sentence; none if they do not.
fn worse_or_better(kind: &str, sigma: f64, scale: f64, criterion: Criterion) -> Option<String> {
    if scale == 1.0 {
        return None;
    }
    let option = match kind {
        "plate" => "--sigma",
        "bars" => "--bar-sigma",
        "holes" => "--hole-sigma",
        _ => "--photo-sigma",
    };
    let why = if scale > 1.0 {
        "this table is worse than stated, or the arm has joint play or errors of its encoders"
    } else {
        "this table is better than stated"
    };
    let used = match criterion {
        Criterion::Huber => "the deviations are of what the residuals show",
        Criterion::LeastSquares => {
            "with --plain the deviations are of what was stated all the same"
        }
    };
    Some(format!(
        "{kind}: the residuals are those of a standard deviation of {}, {scale:.2} times the stated {}: {why}; \
         {used}; state it with {option}",
        micrometres(scale * sigma),
        micrometres(sigma)
    ))
}

/// A length as text.
fn micrometres(metres: f64) -> String {
    format!("{:.1} µm", 1e6 * metres)
}

/// The mean of both offsets from which a plate under an arm without a base is likely to lie turned [rad].
const TURNED: f64 = 0.1;

/// That a plate may lie turned under an arm without a base, as a sentence; none if both zeros are about where they were.
fn turned_plate(robot: &Robot, p: &Parameters) -> Option<String> {
    let together = 0.5 * (p.offsets[0] + p.offsets[1]);
    let is_turned = robot.geometry.lengths()[4] == 0.0 && together.abs() > TURNED;
    is_turned.then(|| {
        format!(
            "both joints' zeros are off by {:.1}° on the mean: with both hips about one axis a plate that lies turned \
             against the arm shows the same, and the arm would draw turned by it; lay the plate's x axis along the arm's",
            together.to_degrees()
        )
    })
}
