//! The position loop of a robot over its workspace, and the bandwidths that follow from it where
//! `[control]` leaves them out.

use super::belts::{INERTIA_RANGE, PAYLOAD_RANGE, links_only};
use super::newest::Newest;
use super::sections::{Control, ControlFile};
use super::{MissingMasses, Robot};
use fivebar_design::servo::{CURRENTS, Gains, Servo, ServoDrive, Tuning, tune};
use fivebar_kinematics::five_bar::Pose;
use fivebar_plant::EncoderSide;
use nalgebra::Matrix2;
use std::f64::consts::TAU;

/// The bandwidth of a position loop times its lag [1]. At 1 kHz its modulus margin is then 0.57, and 0.45 on an arm of 0.7 of
/// the inertia; with the drives' own spring and damper, 0.76 and 0.72.
const PER_LAG: f64 = 0.18;
/// Poses on each side of a grid over the joints' limits.
const GRID: u32 = 9;

/// A pose and the mass matrix there [kg·m²].
pub(super) type PoseMass = (Pose<f64>, Matrix2<f64>);

impl ControlFile {
    /// What the file gives, and the defaults of the rest.
    pub(super) fn given(&self) -> Control {
        self.over(Control::default())
    }

    /// What the file gives, and `rest` otherwise.
    fn over(&self, rest: Control) -> Control {
        Control {
            tick_rate: self.tick_rate.unwrap_or(rest.tick_rate),
            bandwidth: self.bandwidth.unwrap_or(rest.bandwidth),
            damping: self.damping.unwrap_or(rest.damping),
            integral_rate: self.integral_rate.unwrap_or(rest.integral_rate),
            observer_bandwidth: self.observer_bandwidth.unwrap_or(rest.observer_bandwidth),
            current_bandwidth: self.current_bandwidth.unwrap_or(rest.current_bandwidth),
        }
    }

    /// What would follow from the arm.
    fn bandwidths(&self) -> [Option<f64>; 4] {
        [
            self.bandwidth,
            self.integral_rate,
            self.observer_bandwidth,
            self.current_bandwidth,
        ]
    }

    /// Gives drives that act with this lag [s], from the moment that their angles are sensed, the bandwidths that the file
    /// leaves out. To the loop an arm is a double integrator with this lag, whatever its masses. A lag that is not positive
    /// and finite follows from a number that is refused: it gives none, so that only that number is refused.
    pub(super) fn complete_by_lag(&mut self, lag: f64, tick_rate: f64) {
        if !lag.is_finite() || lag <= 0.0 {
            return;
        }
        let current = 0.35 * tick_rate;
        let most = (PER_LAG / lag).min(0.25 * current).floor();
        let bandwidth = *self.bandwidth.get_or_insert(most);
        self.current_bandwidth.get_or_insert(current);
        self.integral_rate.get_or_insert(0.25 * bandwidth);
        let observer = (10.0 * bandwidth).min(tick_rate);
        self.observer_bandwidth.get_or_insert(observer);
    }

    fn is_complete(&self) -> bool {
        self.bandwidths().iter().all(Option::is_some)
    }

    /// Whether the file gives one of them.
    pub(super) fn gives_bandwidths(&self) -> bool {
        self.bandwidths().iter().any(Option::is_some)
    }

    /// What the file gives, and what follows from the arm. An arm without masses or without a
    /// pose, or for which no stable loop is found, gets the defaults.
    pub(super) fn completed(&self, robot: &Robot) -> Control {
        if self.is_complete() {
            return self.given();
        }
        // The loops of belts need a fast current loop.
        let currents = match &robot.belts {
            Some(_) => &CURRENTS[..1],
            None => &CURRENTS[..],
        };
        let Some(found) = Extremes::of(robot).and_then(|arm| arm.tuned(currents)) else {
            return self.given();
        };
        self.over(Control {
            tick_rate: robot.control.tick_rate,
            bandwidth: found.gains.bandwidth,
            damping: found.gains.damping,
            integral_rate: self
                .bandwidth
                .map_or(found.gains.integral_rate, |bandwidth| 0.2 * bandwidth),
            observer_bandwidth: found.gains.observer_bandwidth,
            current_bandwidth: found.gains.current_bandwidth,
        })
    }
}

/// The poses with the least and the greatest inertias and coupling, for which gains are searched.
#[derive(PartialEq)]
struct Extremes {
    /// The mass matrices there [kg·m²].
    masses: Vec<Matrix2<f64>>,
    drives: [ServoDrive; 2],
    /// One tick [s].
    period: f64,
}

impl Extremes {
    fn of(robot: &Robot) -> Option<Self> {
        let drives = robot.servo_drives().ok()?;
        let masses: Vec<Matrix2<f64>> = robot
            .masses()
            .ok()?
            .into_iter()
            .map(|(_, mass)| mass)
            .collect();
        let features: [fn(&Matrix2<f64>) -> f64; 3] = [
            |mass| mass[(0, 0)],
            |mass| mass[(1, 1)],
            |mass| mass.determinant(),
        ];
        let by = |feature: fn(&Matrix2<f64>) -> f64| {
            move |a: &&Matrix2<f64>, b: &&Matrix2<f64>| feature(a).total_cmp(&feature(b))
        };
        let mut extremes: Vec<Matrix2<f64>> = Vec::new();
        for feature in features {
            let ends = [
                masses.iter().min_by(by(feature)),
                masses.iter().max_by(by(feature)),
            ];
            for end in ends.into_iter().flatten() {
                if !extremes.contains(end) {
                    extremes.push(*end);
                }
            }
        }
        Some(Self {
            masses: extremes,
            drives,
            period: 1.0 / robot.control.tick_rate,
        })
    }

    fn tuned(self, currents: &'static [f64]) -> Option<Tuning> {
        static FOUND: Newest<(Extremes, &[f64]), Option<Tuning>> = Newest::new();
        FOUND.of((self, currents), |(arm, currents)| {
            let servo = |&mass: &Matrix2<f64>| Servo::new(mass, arm.drives, arm.period);
            tune(&arm.masses.iter().map(servo).collect::<Vec<_>>(), currents)
        })
    }
}

impl Robot {
    /// Takes the loops of its file, or such as suit its arm.
    pub(super) fn close_loops(&mut self, control: &ControlFile) {
        self.rigid_control = control.completed(self);
        self.belts = control.belts(self);
        self.control = match self.belts {
            Some(_) => control.completed(self),
            None => self.rigid_control,
        };
    }

    /// The gains of the loops.
    pub fn gains(&self) -> Gains {
        let Control {
            bandwidth,
            damping,
            integral_rate,
            observer_bandwidth,
            current_bandwidth,
            ..
        } = self.control;
        Gains {
            bandwidth,
            damping,
            integral_rate,
            observer_bandwidth,
            current_bandwidth,
            belts: self.belts.map(|belts| belts.map(|belt| belt.gains)),
        }
    }

    /// The arms that may be meant at the poses of [`Robot::servos`]: links of −20 to +30 % inertia, without payload
    /// and with twice as much. Those between are combinations of these.
    ///
    /// # Errors
    /// The robot has lengths only, no masses.
    pub fn unlike_servos(&self) -> Result<Vec<[Servo; 4]>, MissingMasses> {
        let drives = self.servo_drives()?;
        let period = 1.0 / self.control.tick_rate;
        let servos =
            |masses: [Matrix2<f64>; 4]| masses.map(|mass| Servo::new(mass, drives, period));
        Ok(self.unlike_masses()?.into_iter().map(servos).collect())
    }

    /// The mass matrices of the arms that may be meant [kg·m²], as of [`Robot::unlike_servos`].
    pub(super) fn unlike_masses(&self) -> Result<Vec<[Matrix2<f64>; 4]>, MissingMasses> {
        let arm = self.arm()?;
        let rotors = Matrix2::from_diagonal(&arm.rotor_inertia().into());
        let arms = PAYLOAD_RANGE.map(|factor| links_only(arm, factor * arm.payload()));
        let [Some(light), Some(heavy)] = arms else {
            return Ok(Vec::new());
        };
        let at = |(pose, _): (Pose<f64>, _)| {
            let masses = [
                light.mass_matrix(&pose).ok()?,
                heavy.mass_matrix(&pose).ok()?,
            ];
            let [low, high] = INERTIA_RANGE;
            let corners = [(low, 0), (low, 1), (high, 0), (high, 1)];
            Some(corners.map(|(factor, of)| masses[of] * factor + rotors))
        };
        Ok(self.masses()?.into_iter().filter_map(at).collect())
    }

    /// The position loop at poses all over the joints' limits, in the robot's assembly and
    /// working mode and clear of singularities. Home comes first.
    ///
    /// # Errors
    /// The robot has lengths only, no masses.
    pub fn servos(&self) -> Result<Vec<(Pose<f64>, Servo)>, MissingMasses> {
        let drives = self.servo_drives()?;
        let period = 1.0 / self.control.tick_rate;
        let servo = |(pose, mass)| (pose, Servo::new(mass, drives, period));
        Ok(self.masses()?.into_iter().map(servo).collect())
    }

    /// The mass matrices at these poses [kg·m²].
    pub(super) fn masses(&self) -> Result<Vec<PoseMass>, MissingMasses> {
        let arm = self.arm()?;
        let poses = self.poses().into_iter();
        Ok(poses
            .filter_map(|pose| Some((pose, arm.mass_matrix(&pose).ok()?)))
            .collect())
    }

    /// Home, and poses all over the joints' limits.
    pub(super) fn poses(&self) -> Vec<Pose<f64>> {
        let home = self.home_pose().ok();
        let assembly = home.as_ref().map(Pose::assembly);
        let clear = |pose: &Pose<f64>| {
            pose.working_mode() == self.elbows
                && pose.nearest_singularity().1 >= self.limits.singularity_margin
        };
        let at =
            |[low, high]: [f64; 2], i: u32| low + (high - low) * f64::from(i) / f64::from(GRID - 1);
        let [range1, range4] = self.limits.angle;
        let grid = (0..GRID * GRID).filter_map(|i| {
            let (theta1, theta4) = (at(range1, i / GRID), at(range4, i % GRID));
            self.geometry.forward(theta1, theta4, assembly?).ok()
        });
        home.into_iter().chain(grid.filter(clear)).collect()
    }

    /// The drives as the position loop meets them.
    ///
    /// # Errors
    /// The robot has lengths only, no masses.
    pub(super) fn servo_drives(&self) -> Result<[ServoDrive; 2], MissingMasses> {
        Ok(self.drives()?.map(|drive| ServoDrive {
            torque_per_current: drive.torque_per_ampere(),
            resistance: drive.resistance,
            inductance: drive.inductance,
            rotor_inertia: drive.motor().reflected_inertia(),
            viscous_friction: drive.viscous_friction,
            stiffness: drive.stiffness,
            damping: drive.drive_damping,
            encoder_at_joint: drive.encoder_side == EncoderSide::Joint,
            encoder_latency: drive.encoder_latency,
            count: TAU / (f64::from(drive.encoder_counts) * drive.gear_ratio.abs()),
            peak_torque: drive.peak_torque(),
        }))
    }
}
