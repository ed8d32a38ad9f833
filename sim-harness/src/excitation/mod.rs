//! An excitation on the simulated arm, under a joint controller that knows the drawing only.
//!
//! The torque is the drawing's at the planned acceleration and a feedback of angle and speed. The
//! identification needs no exact motion, only exact measurements.

mod brushed;
mod can_bus;

use fivebar_design::identification::{Excitation, Regressor, base_parameters, standard_parameters};
use fivebar_files::robot::{Actuator, MissingMasses, NotBrushed, Robot};
use fivebar_firmware::settings::SettingsError;
use fivebar_kinematics::five_bar::{Geometry, Joint, Pose, PoseError, Side};
use fivebar_plant::{Mismatch, MismatchError};
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
    /// The torques of its drives are not known.
    #[error(transparent)]
    Drives(#[from] NotBrushed),
    /// The simulated drives get the springs of the robot's settings.
    #[error(transparent)]
    Settings(#[from] SettingsError),
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

/// The rows of a log of `periods` periods after two in which the trajectory grows from rest: time [s], θ1, θ4 [rad], and of
/// brushed motors the currents of joints 1 and 4 [A], of drives on a bus the torques that they are told in this tick [N·m].
///
/// # Errors
/// The robot has no masses, or drives whose torques are not known; the mismatch does not suit it, or the trajectory leaves
/// its reach.
pub fn excite(
    robot: &Robot,
    excitation: &Excitation,
    periods: u32,
    mismatch: &Mismatch,
    seed: u64,
) -> Result<Vec<[f64; 5]>, ExcitationError> {
    let robot = robot.with_known_torque()?;
    let parameters = robot.plant_parameters()?;
    mismatch.check_for(&parameters)?;
    let mut follower = Follower::new(robot, excitation, periods)?;
    match robot.can_bus() {
        Some(bus) => can_bus::excite(&mut follower, &parameters, bus, mismatch, seed),
        None => brushed::excite(&mut follower, &parameters, mismatch, seed),
    }
}

/// What makes an arm follow an excitation, and keeps its log.
struct Follower<'a> {
    robot: &'a Robot,
    excitation: &'a Excitation,
    drives: [Actuator; 2],
    drawing: Drawing,
    /// In the middle of the motion.
    pose: Pose<f64>,
    middle: [f64; 2],
    /// One tick [s].
    period: f64,
    /// Ticks of the growing motion, and all.
    lead_in: u32,
    ticks: u32,
    /// Of the amplitude, once it is full [1/s].
    change: f64,
    /// Of the first sample.
    origin: Option<[i32; 2]>,
    /// Of the last sample [rad], and the filtered speed [rad/s].
    angle: [f64; 2],
    speed: [f64; 2],
    rows: Vec<[f64; 5]>,
}

impl<'a> Follower<'a> {
    fn new(
        robot: &'a Robot,
        excitation: &'a Excitation,
        periods: u32,
    ) -> Result<Self, ExcitationError> {
        let arm = robot.arm()?;
        let middle = [excitation.coefficients[0], excitation.coefficients[11]];
        let assembly = assembly_of(robot, middle);
        let base = base_parameters(robot.geometry.lengths(), &standard_parameters(arm));
        let used = if robot.gravity == Vector2::zeros() {
            7
        } else {
            11
        };
        let period = 1.0 / robot.control.tick_rate;
        let lead_in = (2.0 * excitation.period / period).round() as u32;
        Ok(Self {
            robot,
            excitation,
            drives: robot.drives()?,
            drawing: Drawing {
                geometry: robot.geometry,
                assembly,
                gravity: robot.gravity,
                base: base[..used].to_vec(),
            },
            pose: robot.geometry.forward(middle[0], middle[1], assembly)?,
            middle,
            period,
            lead_in,
            ticks: lead_in + (f64::from(periods) * excitation.period / period).round() as u32,
            change: 0.0,
            origin: None,
            angle: middle,
            speed: [0.0; 2],
            rows: Vec::new(),
        })
    }

    /// Takes a sample's counts over.
    fn see(&mut self, counts: [i32; 2]) {
        let first = *self.origin.get_or_insert(counts);
        for joint in Joint::ALL {
            let drive = &self.drives[joint];
            let turned = counts[joint].wrapping_sub(first[joint]);
            let per_turn = f64::from(drive.encoder_counts) * drive.gear_ratio;
            let angle = self.middle[joint] + f64::from(turned) * TAU / per_turn;
            let measured = (angle - self.angle[joint]) / self.period;
            self.speed[joint] += SPEED_BANDWIDTH * self.period * (measured - self.speed[joint]);
            self.angle[joint] = angle;
        }
    }

    /// Keeps a row of the log, if this tick is one of it.
    fn log(&mut self, tick: u32, [first, fourth]: [f64; 2]) {
        if tick > self.lead_in {
            let time = f64::from(tick - self.lead_in) * self.period;
            self.rows
                .push([time, self.angle[0], self.angle[1], first, fourth]);
        }
    }

    /// The torques for a tick, friction included [N·m], and the wanted speeds [rad/s].
    fn torques(&self, tick: u32) -> Result<[[f64; 2]; 2], PoseError> {
        let full = f64::from(self.lead_in) * self.period;
        let [q, omega, alpha] = led_in(
            self.excitation,
            f64::from(tick) * self.period,
            full,
            self.change,
        );
        let demanded = Joint::ALL.map(|joint| {
            alpha[joint]
                + DAMPING * (omega[joint] - self.speed[joint])
                + STIFFNESS * (q[joint] - self.angle[joint])
        });
        let torque = self.drawing.torque([q, omega, demanded])?;
        let with_friction = Joint::ALL.map(|joint| {
            let drive = &self.drives[joint];
            let friction = drive.viscous_friction * omega[joint]
                + drive.coulomb_friction * (omega[joint] / 0.02).tanh();
            torque[joint] + friction
        });
        Ok([with_friction, omega])
    }
}

/// The assembly mode with which the elbows are the file's.
fn assembly_of(robot: &Robot, angles: [f64; 2]) -> Side {
    let fits = |side: &Side| {
        let pose = robot.geometry.forward(angles[0], angles[1], *side);
        pose.is_ok_and(|pose| pose.working_mode() == robot.elbows)
    };
    Side::BOTH.into_iter().find(fits).unwrap_or(Side::Left)
}

/// The trajectory, its amplitude growing from 0 to 1 as 10 s³ − 15 s⁴ + 6 s⁵ until `full` [s], and changing at this rate
/// from then on [1/s].
fn led_in(excitation: &Excitation, time: f64, full: f64, change: f64) -> [[f64; 2]; 3] {
    let s = (time / full).min(1.0);
    let over = (time - full).max(0.0);
    let size = s * s * s * (10.0 + s * (6.0 * s - 15.0)) + change * over;
    let of_change = if over > 0.0 { change } else { 0.0 };
    let rate = 30.0 * s * s * (1.0 - s) * (1.0 - s) / full + of_change;
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
