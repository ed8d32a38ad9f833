//! The arm with a torque on each rotor, step by step: for controllers that are not this project's.

use crate::drives::Drives;
use crate::mismatch::Mismatch;
use crate::motor::Motor;
use crate::parameters::Parameters;
use crate::plant::Plant;
use crate::ripple::RipplePeriods;
use fivebar_firmware::ActuatorCommand;
use fivebar_kinematics::five_bar::{Joint, Pose};
use nalgebra::Vector2;

/// Greatest internal step [s]. At 30 rad/s a link then turns by 0.03 rad in a step.
pub const GREATEST_STEP: f64 = 1e-3;
/// Greatest turn of a link in an internal step [rad]; a step with a greater one is halved.
const GREATEST_TURN: f64 = 0.1;
/// A step shorter than twice this is not halved [s].
const LEAST_STEP: f64 = 1e-5;

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
    arm: Plant,
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
        Self { arm }
    }

    /// Advances by `time` [s], above 0, with these torques on the rotors, as they are at the joints [N·m], in internal
    /// steps of at most [`GREATEST_STEP`].
    ///
    /// # Errors
    /// The motion is not finite or too fast. The arm is then as it was.
    pub fn step(&mut self, torque: [f64; 2], time: f64) -> Result<(), TooFast> {
        let before = self.arm.clone();
        if let Some(drives) = &mut self.arm.drives {
            drives.motor_torque = torque;
        }
        let steps = (time / GREATEST_STEP).ceil().max(1.0);
        let done = (0..steps as u64).try_for_each(|_| self.advance(time / steps));
        if done.is_err() {
            self.arm = before;
        }
        done
    }

    /// Advances by one internal step, or by its halves where a link turns too far in it.
    fn advance(&mut self, time: f64) -> Result<(), TooFast> {
        let before = self.arm.clone();
        self.arm.advance(&ActuatorCommand::default(), time);
        let links = self.arm.state().q.iter().zip(&before.state().q);
        let turns = links.map(|(now, before)| (now.angular - before.angular).abs());
        // NaN is no turn that is small enough.
        if self.is_finite() && turns.into_iter().all(|turn| turn <= GREATEST_TURN) {
            return Ok(());
        }
        self.arm = before;
        let half = 0.5 * time;
        match half >= LEAST_STEP {
            true => (0..2).try_for_each(|_| self.advance(half)),
            false => Err(TooFast),
        }
    }

    fn is_finite(&self) -> bool {
        let tool = self.arm.tool();
        let velocities = Joint::ALL.map(|joint| self.velocity(joint));
        tool.iter()
            .chain(&velocities)
            .all(|number| number.is_finite())
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
