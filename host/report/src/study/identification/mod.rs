//! Identification of a robot from a log, and the excitation proposed for it.

mod answer;
mod payload;
mod told;

pub use answer::{answer, payload_answer, proposal_answer, validation_answer};
pub use payload::{measured_payload, payload_of};

use fivebar_design::identification::{
    Bounds, EncoderErrors, FoundErrors, Identification, IdentificationError, Log, Misprediction,
    Observed, Predictor, ProposedExcitation, base_parameters, identify, identify_encoders,
    physical_links, propose_excitation, standard_parameters, validate,
};
use fivebar_files::robot::{HomeError, Measured, MeasuredKey, MissingMasses, Robot};
use fivebar_kinematics::five_bar::Joint;
use nalgebra::Vector2;

/// Periods of a simulated log.
pub const PERIODS: u32 = 10;

/// Why a robot cannot be identified, or an excitation not be proposed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// Without actuators currents are no torques.
    #[error(
        "robot `{0}` has no [[actuator]]: a torque is torque_constant times gear_ratio times the \
         current"
    )]
    NoActuators(String),
    /// The branch is not known.
    #[error(transparent)]
    Home(#[from] HomeError),
    /// An excitation is planned with the drawing's masses.
    #[error(transparent)]
    Masses(#[from] MissingMasses),
    /// The log is refused.
    #[error(transparent)]
    Log(#[from] IdentificationError),
    /// No trajectory keeps within the limits.
    #[error(
        "no excitation was found within the limits of robot `{0}`: widen limits.angle, or check \
         its masses and currents"
    )]
    NoExcitation(String),
}

/// Identifies a robot from rows of time, θ1, θ4, current 1, current 4. With drives on a bus, in the place of the currents are
/// the torques that the drives are told in the row's tick, while they make no spring.
///
/// # Errors
/// The robot has no actuators or no pose at home, or the log is refused.
pub fn identify_robot(robot: &Robot, rows: &[[f64; 5]]) -> Result<Identification, StudyError> {
    let found = identify(&log_of(robot, rows)?, &observed(robot)?)?;
    Ok(told::widened(robot, found))
}

/// Finds the errors of encoders on the motors' shafts from rows as for [`identify_robot`], whose angles are what the
/// encoders show. The errors are searched from `start` on.
///
/// # Errors
/// The robot has no actuators or no pose at home, or the log is refused.
pub fn encoder_errors_of(
    robot: &Robot,
    rows: &[[f64; 5]],
    start: EncoderErrors,
) -> Result<FoundErrors, StudyError> {
    let actuators = robot.actuators.as_ref();
    let actuators = actuators.ok_or_else(|| StudyError::NoActuators(robot.name.clone()))?;
    let ratios = actuators.each_ref().map(|actuator| actuator.gear_ratio);
    Ok(identify_encoders(
        &log_of(robot, rows)?,
        &observed(robot)?,
        ratios,
        start,
    )?)
}

/// How well a robot with this identification predicts the torques of rows as for
/// [`identify_robot`]; its friction is that of the robot file. Without one, masses are the file's, too.
///
/// # Errors
/// The robot has no actuators, masses or pose at home, or the log is refused.
pub fn validate_robot(
    robot: &Robot,
    found: Option<&Identification>,
    rows: &[[f64; 5]],
) -> Result<Misprediction, StudyError> {
    let actuators = robot.actuators.as_ref();
    let actuators = actuators.ok_or_else(|| StudyError::NoActuators(robot.name.clone()))?;
    let base = match found {
        Some(found) => found.base.clone(),
        None => {
            let standard = standard_parameters(robot.arm()?);
            base_parameters(robot.geometry.lengths(), &standard).to_vec()
        }
    };
    let predictor = Predictor {
        base,
        viscous: actuators.each_ref().map(|drive| drive.viscous_friction),
        coulomb: actuators.each_ref().map(|drive| drive.coulomb_friction),
        offset: found.map_or([0.0; 2], |found| found.offset),
    };
    Ok(validate(
        &log_of(robot, rows)?,
        &observed(robot)?,
        &predictor,
    )?)
}

/// How well a second log's torques are predicted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Validations {
    /// By the robot file; none without masses in it.
    pub before: Option<Misprediction>,
    /// By the identification, its friction included.
    pub after: Misprediction,
}

/// Compares the torques of a second log with those that an identification and the robot file
/// predict.
///
/// # Errors
/// The robot has no actuators or pose at home, or the log is refused.
pub fn validations(
    robot: &Robot,
    found: &Identification,
    rows: &[[f64; 5]],
) -> Result<Validations, StudyError> {
    let predictor = Predictor {
        base: found.base.clone(),
        viscous: found.viscous,
        coulomb: found.coulomb,
        offset: found.offset,
    };
    let after = validate(&log_of(robot, rows)?, &observed(robot)?, &predictor)?;
    let share = after.rms / after.torque_rms;
    // Not a number: there are no torques.
    if share.is_nan() || share > 0.5 {
        return Err(IdentificationError::Unpredicted(share).into());
    }
    let before = match robot.arm() {
        Ok(_) => Some(validate_robot(robot, None, rows)?),
        Err(_) => None,
    };
    Ok(Validations { before, after })
}

fn log_of(robot: &Robot, rows: &[[f64; 5]]) -> Result<Log, StudyError> {
    let per_torque = match robot.can_bus() {
        Some(_) => torque_per_ampere(robot)?.map(|torque| 1.0 / torque),
        None => [1.0; 2],
    };
    let mut log = Log::default();
    for [time, theta1, theta4, first, fourth] in told::acted(robot, rows) {
        log.times.push(time);
        log.angles.push([theta1, theta4]);
        log.currents
            .push([first * per_torque[0], fourth * per_torque[1]]);
    }
    Ok(log)
}

/// Torque at the joint per current [N·m/A].
fn torque_per_ampere(robot: &Robot) -> Result<[f64; 2], StudyError> {
    let actuators = robot.actuators.as_ref();
    let actuators = actuators.ok_or_else(|| StudyError::NoActuators(robot.name.clone()))?;
    Ok(actuators
        .each_ref()
        .map(|actuator| actuator.peak_torque() / actuator.peak_current))
}

fn observed(robot: &Robot) -> Result<Observed<'_>, StudyError> {
    let actuators = robot.actuators.as_ref();
    let actuators = actuators.ok_or_else(|| StudyError::NoActuators(robot.name.clone()))?;
    let torque_per_ampere = torque_per_ampere(robot)?;
    Ok(Observed {
        geometry: &robot.geometry,
        assembly: robot.home_pose()?.assembly(),
        mode: robot.elbows,
        gravity: robot.gravity,
        torque_per_ampere,
        current_limit: Joint::ALL.map(|joint| {
            let stated = robot
                .limits
                .max_torque
                .map_or(f64::INFINITY, |torque| torque[joint]);
            actuators[joint]
                .peak_current
                .min(stated / torque_per_ampere[joint])
        }),
        tick_rate: robot.control.tick_rate,
    })
}

/// Two excitations: one to identify, one to validate.
///
/// # Errors
/// The robot has no masses, actuators or pose at home, or no trajectory keeps within its limits.
pub fn propose_for(robot: &Robot) -> Result<[ProposedExcitation; 2], StudyError> {
    let bounds = bounds(robot)?;
    let found = |seed| {
        propose_excitation(&bounds, seed)
            .ok_or_else(|| StudyError::NoExcitation(robot.name.clone()))
    };
    Ok([found(1)?, found(2)?])
}

/// The limits of a robot with a reserve: two thirds of the peak torque, four fifths of the
/// continuous torque, 0.05 rad before the limits of the angles.
fn bounds(robot: &Robot) -> Result<Bounds, StudyError> {
    let actuators = robot.actuators.as_ref();
    let actuators = actuators.ok_or_else(|| StudyError::NoActuators(robot.name.clone()))?;
    let arm = robot.arm()?;
    let home = robot.home_pose()?;
    let middle = robot.best_point()?;
    let best = robot.geometry.inverse(Vector2::from(middle), robot.elbows);
    let angles = best.unwrap_or(home).angles();
    let limits = &robot.limits;
    let stated = |joint: Joint| {
        limits
            .max_torque
            .map_or(f64::INFINITY, |torque| torque[joint])
    };
    let peak = Joint::ALL.map(|joint| actuators[joint].peak_torque().min(stated(joint)));
    let continuous = Joint::ALL.map(|joint| {
        let actuator = &actuators[joint];
        peak[joint] * (actuator.continuous_current / actuator.peak_current).min(1.0)
    });
    let within = |joint: Joint, angle: f64| {
        let [least, greatest] = limits.angle[joint];
        let turns = [0.0, 1.0, -1.0].map(|turn| angle + turn * std::f64::consts::TAU);
        let inside = |angle: &f64| least <= *angle && *angle <= greatest;
        turns.into_iter().find(inside).unwrap_or(angle)
    };
    Ok(Bounds {
        geometry: robot.geometry,
        assembly: home.assembly(),
        mode: robot.elbows,
        gravity: robot.gravity,
        base: base_parameters(robot.geometry.lengths(), &standard_parameters(arm)),
        friction: actuators
            .each_ref()
            .map(|actuator| [actuator.viscous_friction, actuator.coulomb_friction]),
        angle: limits
            .angle
            .map(|[least, greatest]| [least + 0.05, greatest - 0.05]),
        velocity: limits.max_speed.map(|speed| (0.9 * speed).min(20.0)),
        acceleration: limits.max_acceleration.map(|greatest| 0.9 * greatest),
        torque: peak.map(|torque| torque * 2.0 / 3.0),
        torque_rms: continuous.map(|torque| 0.8 * torque),
        margin: limits.singularity_margin.max(0.3),
        middle: [
            within(Joint::Joint1, angles[0]),
            within(Joint::Joint4, angles[3]),
        ],
    })
}

/// The values of the robot file that follow from an identification: the friction of both joints
/// and, if the file has masses, masses with the measured torques.
pub fn measured(robot: &Robot, found: &Identification) -> Vec<Measured> {
    let friction = |joint: Joint, name: &'static str, value: f64, sd: f64| Measured {
        key: MeasuredKey::Actuator(joint, name),
        value: format!("{:.6e}", value.max(0.0)),
        origin: format!("± {sd:.1e} by identification"),
    };
    let mut values: Vec<Measured> = Joint::ALL
        .into_iter()
        .flat_map(|joint| {
            let (viscous, coulomb) = (found.viscous[joint], found.coulomb[joint]);
            let (viscous_sd, coulomb_sd) = (found.viscous_sd[joint], found.coulomb_sd[joint]);
            [
                friction(joint, "viscous_friction", viscous, viscous_sd),
                friction(joint, "coulomb_friction", coulomb, coulomb_sd),
            ]
        })
        .collect();
    values.extend(measured_masses(robot, found));
    values
}

/// The masses of the robot file with the measured torques; none if the file has no masses.
pub fn measured_masses(robot: &Robot, found: &Identification) -> Vec<Measured> {
    let physical = robot
        .arm()
        .ok()
        .and_then(|arm| physical_links(arm, &found.base));
    let links = physical.map(|physical| physical.links);
    let mut values = Vec::new();
    for (index, link) in links.into_iter().flatten().enumerate() {
        for (name, value) in [
            ("mass", format!("{:.9e}", link.mass)),
            ("com", format!("[{:.9e}, {:.9e}]", link.com.x, link.com.y)),
            ("inertia", format!("{:.9e}", link.inertia)),
        ] {
            values.push(Measured {
                key: MeasuredKey::Link(index, name),
                value,
                origin: "together with the other links, by identification".into(),
            });
        }
    }
    values
}

/// How far the base parameters are from those of any real arm, as a sentence; none if they are
/// close enough.
pub fn warning(robot: &Robot, found: &Identification) -> Option<String> {
    let physical = physical_links(robot.arm().ok()?, &found.base)?;
    (physical.difference > 0.02).then(|| {
        format!(
            "the base parameters are those of no real arm: the nearest differs by {:.3} (1e-3 \
             kg·m² or 1e-2 kg·m); check the torque constants, and calibrate first",
            physical.difference
        )
    })
}
