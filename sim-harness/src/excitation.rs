//! An excitation on the simulated arm, under a joint controller that knows the drawing only.
//!
//! The torque is the drawing's at the planned acceleration and a feedback of angle and speed; the
//! voltage is the resistance's and the back-EMF's. The identification needs no exact motion, only
//! exact measurements.

use fivebar_design::identification::{Excitation, Regressor, base_parameters, standard_parameters};
use fivebar_files::robot::{Actuator, MissingMasses, Robot};
use fivebar_firmware::drives::BrushedCommand;
use fivebar_firmware::io::ActuatorCommand;
use fivebar_kinematics::five_bar::{Geometry, Joint, PoseError, Side};
use fivebar_plant::{Mismatch, MismatchError, Plant};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// Why an excitation cannot be simulated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExcitationError {
    /// The simulated arm needs masses.
    #[error(transparent)]
    Masses(#[from] MissingMasses),
    /// The mismatch does not suit the arm.
    #[error(transparent)]
    Mismatch(#[from] MismatchError),
    /// The trajectory leaves the arm's reach.
    #[error("the excitation leaves the arm's reach: {0}")]
    Pose(#[from] PoseError),
}

/// Stiffness and damping of the feedback: a bandwidth of 100 rad/s.
const STIFFNESS: f64 = 1e4;
const DAMPING: f64 = 200.0;
/// Bandwidth of the measured speed [rad/s].
const SPEED_BANDWIDTH: f64 = 1000.0;

/// The drawing, for the feed-forward.
struct Drawing {
    geometry: Geometry<f64>,
    assembly: Side,
    gravity: Vector2<f64>,
    base: Vec<f64>,
}

impl Drawing {
    fn torque(&self, motion: [[f64; 2]; 3]) -> Result<[f64; 2], PoseError> {
        let at = Regressor::at(&self.geometry, self.assembly, self.gravity, motion)?;
        Ok(at.torque(&self.base))
    }
}

/// The rows of a log, with time [s], θ1, θ4 [rad] and the currents of joints 1 and 4 [A], of
/// `periods` periods after two in which the trajectory grows from rest.
///
/// # Errors
/// The robot has no masses, the mismatch does not suit it, or the trajectory leaves its reach.
pub fn excite(
    robot: &Robot,
    excitation: &Excitation,
    periods: u32,
    mismatch: &Mismatch,
    seed: u64,
) -> Result<Vec<[f64; 5]>, ExcitationError> {
    let parameters = robot.plant_parameters()?;
    mismatch.check_for(&parameters)?;
    let arm = robot.arm()?;
    let middle = [excitation.coefficients[0], excitation.coefficients[11]];
    let assembly = assembly_of(robot, middle);
    let pose = robot.geometry.forward(middle[0], middle[1], assembly)?;
    let base = base_parameters(robot.geometry.lengths(), &standard_parameters(arm));
    let used = if robot.gravity == Vector2::zeros() {
        7
    } else {
        11
    };
    let drawing = Drawing {
        geometry: robot.geometry,
        assembly,
        gravity: robot.gravity,
        base: base[..used].to_vec(),
    };
    let drives = robot.drives()?;
    let mut plant = Plant::new(&parameters, mismatch, &pose, seed);
    let period = 1.0 / robot.control.tick_rate;
    let settings = parameters.settings;
    let zero = settings.axes.map(|axis| f64::from(axis.current_zero_code));
    let per_code = settings.axes.map(|axis| f64::from(axis.current_per_code));
    let mut origin: Option<[i32; 2]> = None;
    let (mut last_angle, mut last_current, mut speed) = (middle, [0.0; 2], [0.0; 2]);
    let lead_in = (2.0 * excitation.period / period).round() as u32;
    let ticks = lead_in + (f64::from(periods) * excitation.period / period).round() as u32;
    let mut rows = Vec::new();
    for tick in 0..=ticks {
        let sample = plant.sense();
        let first = *origin.get_or_insert(sample.counts);
        let angle = Joint::ALL.map(|joint| {
            let counts = sample.counts[joint].wrapping_sub(first[joint]);
            let per_turn = f64::from(drives[joint].encoder_counts) * drives[joint].gear_ratio;
            middle[joint] + f64::from(counts) * TAU / per_turn
        });
        let current = Joint::ALL.map(|joint| {
            let sign = drives[joint].gear_ratio.signum();
            sign * (f64::from(sample.drives.current[joint]) - zero[joint]) * per_code[joint]
        });
        for joint in Joint::ALL {
            let measured = (angle[joint] - last_angle[joint]) / period;
            speed[joint] += SPEED_BANDWIDTH * period * (measured - speed[joint]);
        }
        if tick > lead_in {
            let time = f64::from(tick - lead_in) * period;
            // The mean of both ends of the tick: the current that acted within it.
            let acted = Joint::ALL.map(|joint| 0.5 * (current[joint] + last_current[joint]));
            rows.push([time, angle[0], angle[1], acted[0], acted[1]]);
        }
        (last_angle, last_current) = (angle, current);
        let wanted = led_in(
            excitation,
            f64::from(tick) * period,
            f64::from(lead_in) * period,
        );
        let voltage = voltages(&drawing, &drives, wanted, angle, speed)?;
        let duty = voltage.map(|volts| (volts / robot.supply.voltage).clamp(-0.95, 0.95) as f32);
        let command = ActuatorCommand {
            drives: BrushedCommand { duty },
            enable: [true; 2],
            brake: false,
            tool: 0,
        };
        plant.step(&command, period);
    }
    Ok(rows)
}

/// The assembly mode with which the elbows are the file's.
fn assembly_of(robot: &Robot, angles: [f64; 2]) -> Side {
    let fits = |side: &Side| {
        let pose = robot.geometry.forward(angles[0], angles[1], *side);
        pose.is_ok_and(|pose| pose.working_mode() == robot.elbows)
    };
    Side::BOTH.into_iter().find(fits).unwrap_or(Side::Left)
}

/// The trajectory, its amplitude growing from 0 to 1 as 10 s³ − 15 s⁴ + 6 s⁵ until `full` [s].
fn led_in(excitation: &Excitation, time: f64, full: f64) -> [[f64; 2]; 3] {
    let s = (time / full).min(1.0);
    let size = s * s * s * (10.0 + s * (6.0 * s - 15.0));
    let rate = 30.0 * s * s * (1.0 - s) * (1.0 - s) / full;
    let bend = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (full * full);
    let [q, omega, alpha] = excitation.at(time);
    let middle = [excitation.coefficients[0], excitation.coefficients[11]];
    let of = |derivative: usize, joint: Joint| {
        let (q, omega, alpha) = (q[joint] - middle[joint], omega[joint], alpha[joint]);
        match derivative {
            0 => middle[joint] + size * q,
            1 => size * omega + rate * q,
            _ => size * alpha + 2.0 * rate * omega + bend * q,
        }
    };
    [0, 1, 2].map(|derivative| Joint::ALL.map(|joint| of(derivative, joint)))
}

/// The voltages at the motors [V].
fn voltages(
    drawing: &Drawing,
    drives: &[Actuator; 2],
    [q, omega, alpha]: [[f64; 2]; 3],
    angle: [f64; 2],
    speed: [f64; 2],
) -> Result<[f64; 2], PoseError> {
    let demanded = Joint::ALL.map(|joint| {
        alpha[joint]
            + DAMPING * (omega[joint] - speed[joint])
            + STIFFNESS * (q[joint] - angle[joint])
    });
    let torque = drawing.torque([q, omega, demanded])?;
    Ok(Joint::ALL.map(|joint| {
        let drive = &drives[joint];
        let friction = drive.viscous_friction * omega[joint]
            + drive.coulomb_friction * (omega[joint] / 0.02).tanh();
        let constant = drive.torque_constant * drive.gear_ratio;
        let current = (torque[joint] + friction) / constant;
        drive.resistance * current + constant * omega[joint]
    }))
}
