//! The arm with a torque on each rotor, step by step: for controllers that are not this project's.

use crate::drive::DriveState;
use crate::drives::Drives;
use crate::dynamics::{DRIVEN, State};
use crate::mismatch::Mismatch;
use crate::motor::Motor;
use crate::parameters::Parameters;
use crate::planar::PlanarVector;
use crate::plant::Plant;
use crate::ripple::RipplePeriods;
use fivebar_firmware::ActuatorCommand;
use fivebar_kinematics::five_bar::{Joint, Pose};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// Greatest internal step [s]. At 30 rad/s a link then turns by 0.03 rad in a step.
pub const GREATEST_STEP: f64 = 1e-3;
/// Greatest turn of a link in an internal step [rad]; a step with a greater one is halved.
pub(crate) const GREATEST_TURN: f64 = 0.1;
/// A step shorter than twice this is not halved [s].
const LEAST_STEP: f64 = 1e-5;

/// All that changes while the arm moves: an arm put back into it moves on with the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueState {
    /// Centres of mass [m] and angles [rad] of links 1 to 4.
    pub q: [PlanarVector; 4],
    /// Their rates.
    pub v: [PlanarVector; 4],
    /// The drives: rotors behind belts, and friction that holds.
    pub drives: [DriveState; 2],
    /// The time since the start [s].
    pub time: f64,
}

impl TorqueState {
    /// Its numbers.
    pub const NUMBERS: usize = 31;

    /// It as numbers: x, y, angle of each link, then their rates, then angle, speed and bristles of each drive, then the time.
    pub fn to_numbers(&self) -> [f64; Self::NUMBERS] {
        let links = self.q.iter().chain(&self.v);
        let links = links.flat_map(|link| [link.linear.x, link.linear.y, link.angular]);
        let drives = self.drives.iter();
        let drives = drives.flat_map(|drive| [drive.angle, drive.speed, drive.bristles]);
        let mut all = links.chain(drives).chain([self.time]);
        std::array::from_fn(|_| all.next().unwrap_or_default())
    }

    /// It from [`TorqueState::to_numbers`].
    pub fn from_numbers(numbers: &[f64; Self::NUMBERS]) -> Self {
        let three = |first: usize| [numbers[first], numbers[first + 1], numbers[first + 2]];
        let link = |first: usize| {
            let [x, y, angular] = three(first);
            PlanarVector {
                linear: Vector2::new(x, y),
                angular,
            }
        };
        let drive = |first: usize| {
            let [angle, speed, bristles] = three(first);
            DriveState {
                angle,
                speed,
                bristles,
            }
        };
        Self {
            q: [0, 3, 6, 9].map(link),
            v: [12, 15, 18, 21].map(link),
            drives: [24, 27].map(drive),
            time: numbers[30],
        }
    }
}

/// The arm cannot be simulated on: its motion is not finite, or a link turns too fast for the least internal step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "within 20 µs a link would turn by more than 0.1 rad, or not by a finite angle: make the torques [N·m] or the force [N] \
     smaller"
)]
pub struct TooFast;

/// An arm whose drives make the torques that they are told, at once and without a limit.
///
/// It is a [`Plant`] whose bridges are off: links, rotors, friction, belts and gravity are the same. It has no brakes.
///
/// ```
/// use fivebar_firmware::Settings;
/// use fivebar_kinematics::five_bar::Joint;
/// use fivebar_plant::{Mismatch, Parameters, TorquePlant};
///
/// let settings = Settings::BENCHTOP;
/// let parameters = Parameters::from_settings(&settings, 24.0).unwrap();
/// let geometry = parameters.arm.geometry();
/// let start = geometry.forward(2.2, 0.9, settings.assembly()).unwrap(); // rad
/// let mut arm = TorquePlant::new(&parameters, &Mismatch::NONE, &start);
/// for _ in 0..100 {
///     arm.step([0.05, 0.0], 1e-3).unwrap(); // N·m, s
/// }
/// assert!(arm.angle(Joint::Joint1) > 2.2);
/// ```
#[derive(Clone, Debug)]
pub struct TorquePlant {
    pub(crate) arm: Plant,
    /// Greatest error of an angle in an internal step [rad], estimated by its halves; none for steps of
    /// [`GREATEST_STEP`] without an estimate.
    pub(crate) tolerance: Option<f64>,
}

impl TorquePlant {
    /// The arm with this mismatch, at rest in `pose`.
    pub fn new(parameters: &Parameters, mismatch: &Mismatch, pose: &Pose<f64>) -> Self {
        let mut parameters = parameters.clone();
        parameters.brake_torque = [0.0; 2];
        for motor in &mut parameters.motors {
            *motor = Motor {
                // No brushed motor: a winding without effect, which needs no short step.
                torque_constant: 0.0,
                resistance: 1.0,
                inductance: 1.0,
                ..*motor
            };
        }
        let mut arm = Plant::new(&parameters, mismatch, pose, 1);
        arm.drives = Some(Drives::new(
            &parameters,
            mismatch,
            RipplePeriods::OUTRUNNER,
            (arm.model(), arm.state()),
        ));
        Self {
            arm,
            tolerance: None,
        }
    }

    /// The same arm, integrated in internal steps of at most this error of each link's angle [rad]. The error of a step is
    /// estimated by its halves, which are then used. A step shorter than 20 µs is taken as it is: friction that changes its
    /// sign within one has no smaller error.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = Some(tolerance);
        self
    }

    /// Its state.
    pub fn state(&self) -> TorqueState {
        let State { q, v, .. } = *self.arm.state();
        TorqueState {
            q,
            v,
            drives: self
                .arm
                .drives
                .as_ref()
                .map_or_else(|| [DriveState::default(); 2], |drives| *drives.state()),
            time: self.arm.time(),
        }
    }

    /// Puts the arm into a state of its own, or of an arm with the same lengths and masses.
    pub fn set_state(&mut self, state: &TorqueState) {
        let TorqueState { q, v, drives, time } = *state;
        self.arm.set_links(&State {
            q,
            v,
            current: [0.0; 2],
        });
        self.arm.set_time(time);
        if let Some(own) = &mut self.arm.drives {
            own.set_state(drives);
        }
    }

    /// Puts the arm into a pose with these velocities of links 1 to 4 [rad/s]; each link in the turn that is nearest to its
    /// angle before. The time goes on.
    pub fn set_motion(&mut self, pose: &Pose<f64>, omega: [f64; 4]) {
        let State { mut q, v, .. } = self.arm.model().state_at(pose, omega);
        for (link, before) in q.iter_mut().zip(self.arm.state().q) {
            link.angular += ((before.angular - link.angular) / TAU).round() * TAU;
        }
        let drives = Joint::ALL.map(|joint| {
            let link = DRIVEN[joint];
            let rotor = |drives: &Drives| drives.rotor_at(joint, q[link].angular);
            DriveState {
                angle: self.arm.drives.as_ref().map_or(0.0, rotor),
                speed: v[link].angular,
                bristles: 0.0,
            }
        });
        let time = self.arm.time();
        self.set_state(&TorqueState { q, v, drives, time });
    }

    /// Advances by `time` [s], above 0, with these torques on the rotors, as they are at the joints [N·m], in internal
    /// steps of at most [`GREATEST_STEP`].
    ///
    /// # Errors
    /// The motion is not finite or too fast. The arm is then as it was.
    pub fn step(&mut self, torque: [f64; 2], time: f64) -> Result<(), TooFast> {
        self.set_torque(torque);
        self.step_on(time)
    }

    /// Sets the torques on the rotors, as they are at the joints [N·m].
    pub(crate) fn set_torque(&mut self, torque: [f64; 2]) {
        if let Some(drives) = &mut self.arm.drives {
            drives.motor_torque = torque;
        }
    }

    /// [`TorquePlant::step`] with the torques that are set.
    pub(crate) fn step_on(&mut self, time: f64) -> Result<(), TooFast> {
        let before = self.state();
        let steps = internal_steps(time);
        let done = (0..steps as u64).try_for_each(|_| self.advance(time / steps));
        if done.is_err() {
            self.set_state(&before);
        }
        done
    }

    /// Advances by one internal step, or by its halves where a link turns too far in it or its error is too great.
    pub(crate) fn advance(&mut self, time: f64) -> Result<(), TooFast> {
        let before = self.state();
        let half = 0.5 * time;
        self.arm.advance(&ActuatorCommand::default(), time);
        if self.has_turned_within(GREATEST_TURN, &before.q) {
            let Some(tolerance) = self.tolerance.filter(|_| half >= LEAST_STEP) else {
                return Ok(());
            };
            let whole = self.arm.state().q;
            self.set_state(&before);
            for _ in 0..2 {
                self.arm.advance(&ActuatorCommand::default(), half);
            }
            // The error of both halves is a fifteenth of the difference, as the method is of fourth order.
            if self.has_turned_within(15.0 * tolerance, &whole) {
                return Ok(());
            }
        }
        self.set_state(&before);
        match half >= LEAST_STEP {
            true => (0..2).try_for_each(|_| self.advance(half)),
            false => Err(TooFast),
        }
    }

    /// Whether its motion is finite, and no link farther than `most` [rad] from these positions.
    pub(crate) fn has_turned_within(&self, most: f64, from: &[PlanarVector; 4]) -> bool {
        let State { q, v, .. } = self.arm.state();
        let mut links = q.iter().zip(from);
        let mut numbers = q
            .iter()
            .chain(v)
            .flat_map(|link| [link.linear.x, link.linear.y, link.angular]);
        // NaN is no turn that is small enough.
        links.all(|(now, from)| (now.angular - from.angular).abs() <= most)
            && numbers.all(f64::is_finite)
    }

    /// Lets this force [N] act on the tool from now on.
    pub fn set_tool_force(&mut self, force: Vector2<f64>) {
        self.arm.set_tool_force(force);
    }

    /// The angle of a driven joint [rad].
    pub fn angle(&self, joint: Joint) -> f64 {
        self.arm.angle(joint)
    }

    /// Its velocity [rad/s].
    pub fn velocity(&self, joint: Joint) -> f64 {
        self.arm.velocity(joint)
    }

    /// The position of the tool [m].
    pub fn tool(&self) -> Vector2<f64> {
        self.arm.tool()
    }

    /// The time since the start [s].
    pub fn time(&self) -> f64 {
        self.arm.time()
    }
}

/// The internal steps of a step of `time` [s].
pub(crate) fn internal_steps(time: f64) -> f64 {
    (time / GREATEST_STEP).ceil().max(1.0)
}
