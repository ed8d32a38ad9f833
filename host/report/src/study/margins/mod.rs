//! The margins of a robot's position loop over its workspace.

mod answer;
mod bus;
mod stiffness;

use fivebar_design::servo::{Gains, LoopPoint, Margins, Servo};
use fivebar_files::robot::{MissingMasses, Robot};
use fivebar_kinematics::five_bar::Pose;
use rayon::prelude::*;

pub use stiffness::PassiveStiffness;

/// Why a robot's loop has no margins.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MarginsError {
    /// No masses.
    #[error(transparent)]
    Masses(#[from] MissingMasses),
    /// The arm can be nowhere.
    #[error(
        "robot `{0}` has no pose within its joint limits and clear of singularities: check `home`, \
         `working_mode` and `[limits]`"
    )]
    NoPose(String),
}

/// The margins at one pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseMargins {
    /// θ1, θ4 [rad].
    pub theta: [f64; 2],
    /// The tool's position [m].
    pub tool: [f64; 2],
    /// Its margins; none if the loop is unstable there.
    pub margins: Option<Margins>,
    /// The greatest |z| of the closed loop's poles; of a loop through a bus, whose poles are not computed, 1 if it is unstable
    /// and else 0.
    pub radius: f64,
}

/// The margins over the workspace.
#[derive(Clone, Debug)]
pub struct MarginsStudy<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// All poses; home is the first.
    pub poses: Vec<PoseMargins>,
    /// The index of the pose with the least modulus margin, or of the most unstable one.
    pub worst: usize,
    /// The open loop there.
    pub loci: Vec<LoopPoint>,
    /// The free frequency of each drive there [Hz]; none for a rigid drive.
    pub resonance: [Option<f64>; 2],
    /// The free frequencies of the arm on its belts there [Hz], the lower one first; none for a rigid drive.
    pub modes: [Option<f64>; 2],
    /// Torque by the encoders' counts there, root mean square, as a share of the peak torque.
    pub noise: f64,
    /// The least modulus margin over all poses of arms with −20 to +30 % of the links' inertia and 0 to twice the
    /// payload; none if one of them is unstable.
    pub modulus_range: Option<f64>,
    /// The greatest compliance of the tip per its static one, over all poses; none if the loop is unstable, or goes through a
    /// bus.
    pub disturbance_peak: Option<f64>,
    /// How stiff springs may be that the arm renders at its tip; none of drives that render none.
    pub passive_stiffness: Option<PassiveStiffness>,
}

impl<'a> MarginsStudy<'a> {
    /// Computes the margins at home and on a grid over the joints' limits.
    ///
    /// # Errors
    /// A robot without masses, or without a pose.
    pub fn new(robot: &'a Robot) -> Result<Self, MarginsError> {
        if let Some(servos) = robot.bus_servos()? {
            return Self::through_bus(robot, &servos);
        }
        let gains = robot.gains();
        let servos = robot.servos()?;
        let mut poses: Vec<PoseMargins> = servos
            .par_iter()
            .map(|(pose, servo)| {
                let law = servo.law(&gains);
                let radius = servo.spectral_radius(&law, 1.0);
                PoseMargins {
                    margins: (radius < 1.0).then(|| servo.margins(&law)),
                    radius,
                    ..PoseMargins::at(pose)
                }
            })
            .collect();
        let worst = worst_of(robot, &poses)?;
        let servo: &Servo = &servos[worst].1;
        let law = servo.law(&gains);
        if let Some(margins) = &mut poses[worst].margins {
            *margins = servo.margins_by_poles(&law);
        }
        Ok(Self {
            robot,
            worst,
            loci: servo.loci(&law),
            resonance: [0, 1].map(|j| {
                let drive = &servo.drives[j];
                drive.resonance(servo.mass_matrix[(j, j)] - drive.rotor_inertia)
            }),
            modes: servo.modes(),
            noise: servo.noise(&law),
            modulus_range: modulus_range(robot, &servos, &gains)?,
            disturbance_peak: disturbance_peak(robot, &servos, &gains),
            passive_stiffness: PassiveStiffness::new(robot, servos.iter().map(|(pose, _)| pose))?,
            poses,
        })
    }

    /// Bandwidth of the current loop, which drives on a bus have of their own [rad/s].
    pub fn current_bandwidth(&self) -> f64 {
        let drives = self.robot.can_drives();
        drives.map_or(self.robot.control.current_bandwidth, |[first, _]| {
            first.current_bandwidth
        })
    }

    /// The worst pose.
    pub fn worst(&self) -> &PoseMargins {
        &self.poses[self.worst]
    }
}

/// The index of the pose with the least modulus margin, or of the most unstable one.
fn worst_of(robot: &Robot, poses: &[PoseMargins]) -> Result<usize, MarginsError> {
    let badness = |pose: &PoseMargins| pose.margins.map_or(pose.radius, |m| -m.modulus);
    (0..poses.len())
        .max_by(|&a, &b| badness(&poses[a]).total_cmp(&badness(&poses[b])))
        .ok_or_else(|| MarginsError::NoPose(robot.name.clone()))
}

/// The least modulus margin of the arms that may be meant.
fn modulus_range(
    robot: &Robot,
    servos: &[(Pose<f64>, Servo)],
    gains: &Gains,
) -> Result<Option<f64>, MissingMasses> {
    let unlike = robot.unlike_servos()?;
    let pairs = servos.par_iter().zip(&unlike);
    Ok(pairs
        .map(|((_, model), arms)| {
            let law = model.law(gains);
            let margin = |arm: &Servo| {
                let stable = arm.spectral_radius(&law, 1.0) < 1.0;
                stable.then(|| arm.margins(&law).modulus)
            };
            arms.iter().map(margin).try_fold(f64::INFINITY, least)
        })
        .try_reduce(|| f64::INFINITY, |one, other| Some(one.min(other))))
}

fn least(so_far: f64, next: Option<f64>) -> Option<f64> {
    next.map(|next| so_far.min(next))
}

/// The greatest compliance of the tip per its static one.
fn disturbance_peak(robot: &Robot, servos: &[(Pose<f64>, Servo)], gains: &Gains) -> Option<f64> {
    let tool = robot.tool_on_link().ok()?;
    servos
        .par_iter()
        .map(|(pose, servo)| {
            let law = servo.law(gains);
            let jacobian = tool.jacobian(pose).ok()?;
            let stable = servo.spectral_radius(&law, 1.0) < 1.0;
            stable.then(|| servo.disturbance_peak(&law, &jacobian.matrix()))
        })
        .try_reduce(|| 0.0, |one, other| Some(one.max(other)))
}

impl PoseMargins {
    fn at(pose: &Pose<f64>) -> Self {
        let [theta1, _, _, theta4] = pose.angles();
        Self {
            theta: [theta1, theta4],
            tool: pose.c.into(),
            margins: None,
            radius: f64::NAN,
        }
    }
}
