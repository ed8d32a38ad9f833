//! Requests of the host, and why one can be refused.

use super::{ArmController, Excitation, Setpoint};
use crate::drives::Drives;
use crate::safety::{Event, Fault, State};
use crate::settings::HomingMethod;
use fivebar_kinematics::five_bar::Pose;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// Joint speed above which angles are not taken as given [rad/s].
const GIVEN_REST_SPEED: f32 = 0.05;

/// What a host can ask of the controller, besides moves.
///
/// ```
/// use fivebar_firmware::controller::{Request, RequestError};
/// use fivebar_firmware::safety::State;
/// use fivebar_firmware::{Controller, Settings};
///
/// let mut controller = Controller::new(&Settings::BENCHTOP.check()?);
/// // An arm that does not know its joint angles is not armed.
/// assert_eq!(controller.request(Request::Arm), Err(RequestError::NotHomed));
/// controller.request(Request::SetAngles([2.2, 0.9]))?; // rad
/// controller.request(Request::Arm)?;
/// assert_eq!(controller.state(), State::Armed);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Request {
    /// Switch the bridges on and hold the arm.
    Arm,
    /// Switch the bridges off.
    Disarm,
    /// Find the joint angles, by the settings' [`HomingMethod`].
    Home,
    /// Set the joints' present angles to θ1, θ4 [rad].
    SetAngles([f32; 2]),
    /// Come to rest on the path, drop the rest of it and hold.
    Stop,
    /// Switch the bridges off at once and latch the fault.
    EmergencyStop,
    /// Leave the fault.
    ClearFault,
    /// Put a voltage or a current on one motor of an arm that is not homed.
    Excite(Excitation),
}

/// Why a request was refused. A refused request changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum RequestError {
    /// The state does not allow it.
    State(State),
    /// The joint angles are not known: home first.
    NotHomed,
    /// A joint is outside its limits.
    OutsideLimits,
    /// The arm is too near a singularity.
    NearSingularity,
    /// No pose on the branch of the settings has these angles.
    NotOnBranch,
    /// The arm still moves.
    Moving,
    /// A current sensor reads a current with the bridges off.
    CurrentZero,
    /// The arm is homed, and an excitation would move it without feedback.
    Homed,
    /// A value of the excitation is out of its bounds.
    Excitation,
}

impl core::fmt::Display for RequestError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::State(state) => return write!(f, "it is not possible while {state:?}"),
            Self::NotHomed => "the joint angles are not known: home first",
            Self::OutsideLimits => "a joint is outside its limits",
            Self::NearSingularity => "the arm is too near a singularity",
            Self::NotOnBranch => "the angles close no arm on the branch of the settings",
            Self::Moving => "the arm still moves",
            Self::CurrentZero => "a current sensor reads a current with the bridges off: check it",
            Self::Homed => "the arm is homed, and is not moved without feedback",
            Self::Excitation => "a value of the excitation is out of its bounds",
        })
    }
}

impl core::error::Error for RequestError {}

impl<D: Drives> ArmController<D> {
    /// Executes a request. Counts as a sign of life of the host.
    ///
    /// # Errors
    /// Why the request is refused; nothing has changed then.
    pub fn request(&mut self, request: Request) -> Result<(), RequestError> {
        self.feed_host_timeout();
        let powers = matches!(request, Request::Arm | Request::Home | Request::Excite(_));
        if powers && self.state == State::Stopped && !self.drives.is_ready() {
            return Err(RequestError::CurrentZero);
        }
        let event = match request {
            Request::Arm => {
                self.prepare_to_hold()?;
                self.stay_armed();
                Event::Arm
            }
            Request::Excite(excitation) => {
                if self.state != State::Stopped {
                    return Err(RequestError::State(self.state));
                }
                self.prepare_excitation(&excitation)?;
                Event::Excite
            }
            Request::Disarm => return self.switch_off(Event::Disarm).map_err(RequestError::State),
            Request::Home => {
                self.require_rest_for_given_angles()?;
                Event::Home
            }
            Request::SetAngles(angles) => return self.set_angles(angles),
            Request::Stop if self.state == State::Homing => {
                return self.switch_off(Event::Stop).map_err(RequestError::State);
            }
            Request::Stop => Event::Stop,
            Request::EmergencyStop => {
                self.latch_fault(Fault::EmergencyStop);
                return Ok(());
            }
            Request::ClearFault if self.moves_under_fault() => return Err(RequestError::Moving),
            Request::ClearFault => {
                return self.switch_off(Event::Clear).map_err(RequestError::State);
            }
        };
        self.dispatch(event).map_err(RequestError::State)
    }

    /// Sets the set-point to the arm's present position, if it may be armed there. An arm that
    /// is armed already keeps its set-point.
    fn prepare_to_hold(&mut self) -> Result<(), RequestError> {
        if self.state != State::Stopped {
            return Ok(());
        }
        if !self.homed {
            return Err(RequestError::NotHomed);
        }
        let pose = self.pose_to_arm(self.angles())?;
        self.mode = self.model.tool.working_mode(&pose);
        self.setpoint = Setpoint::hold([pose.u1, pose.u4]);
        Ok(())
    }

    /// An arm whose angles are given must not turn away from them meanwhile.
    fn require_rest_for_given_angles(&self) -> Result<(), RequestError> {
        let given = self.settings.home_reference.method == HomingMethod::Given;
        let moves = self
            .velocities()
            .iter()
            .any(|velocity| Scalar::abs(*velocity) > GIVEN_REST_SPEED);
        if given && moves {
            return Err(RequestError::Moving);
        }
        Ok(())
    }

    fn set_angles(&mut self, angles: [f32; 2]) -> Result<(), RequestError> {
        if self.state != State::Stopped {
            return Err(RequestError::State(self.state));
        }
        let pose = self.pose_to_arm(angles)?;
        if self.model.tool.working_mode(&pose) != self.settings.working_mode() {
            return Err(RequestError::NotOnBranch);
        }
        for (((joint, axis), encoder), angle) in self
            .joints
            .iter_mut()
            .zip(&self.model.axes)
            .zip(&mut self.encoders)
            .zip(angles)
        {
            joint.set_origin(axis, joint.counts(), angle);
            if let Some(encoder) = encoder {
                encoder.set_origin(angle, encoder.shown_at(angle));
            }
        }
        self.homed = true;
        self.homed_by_index = false;
        Ok(())
    }

    /// The pose at these joint angles [rad], if the arm may be armed there.
    fn pose_to_arm(&self, [theta1, theta4]: [f32; 2]) -> Result<Pose<f32>, RequestError> {
        let settings = &self.settings;
        let within = settings
            .axes
            .iter()
            .zip([theta1, theta4])
            .all(|(axis, theta)| {
                let [low, high] = axis.angle_limits;
                low <= theta && theta <= high
            });
        if !within {
            return Err(RequestError::OutsideLimits);
        }
        let pose = self
            .model
            .tool
            .geometry()
            .forward_from_directions(
                Vector2::unit(theta1),
                Vector2::unit(theta4),
                self.model.assembly,
            )
            .map_err(|_| RequestError::NotOnBranch)?;
        // Near type 1 the joints still determine the arm's position, so it may be armed there.
        if Scalar::abs(pose.sin32()) < settings.motion.singularity_margin {
            return Err(RequestError::NearSingularity);
        }
        Ok(pose)
    }
}
