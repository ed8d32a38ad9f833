//! Requests of the host, and why one can be refused.

use super::{ArmController, Excitation, Setpoint, encoder};
use crate::drives::{Drives, UnpoweredPlace};
use crate::safety::{Event, Fault, State};
use crate::settings::{HomingMethod, Settings};
use fivebar_kinematics::five_bar::{Side, Tool, WorkingMode};
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
    /// Set the joints' present angles to θ1, θ4 [rad]. Drives that only power keeps in place take power for
    /// it and hold the arm, as for [`Request::Arm`].
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

/// The joint angles of a request. The reader solves them, so that the controller is locked only while they
/// are copied.
#[derive(Clone, Copy, Debug)]
pub struct Posture {
    /// θ1, θ4 [rad].
    angles: [f32; 2],
    assembly: Side,
}

/// A posture in which the arm may be armed.
#[derive(Clone, Copy, Debug)]
pub struct Stance {
    /// u(θ1), u(θ4).
    direction: [Vector2<f32>; 2],
    mode: WorkingMode,
    /// What encoders with a known error show there.
    shown: [f32; 2],
}

impl Posture {
    /// The stance, if the arm of these settings, with this tool, may be armed there.
    ///
    /// # Errors
    /// Why not.
    pub fn stance(&self, settings: &Settings, tool: &Tool<f32>) -> Result<Stance, RequestError> {
        let [theta1, theta4] = self.angles;
        let within = settings.axes.iter().zip(self.angles).all(|(axis, theta)| {
            let [low, high] = axis.angle_limits;
            low <= theta && theta <= high
        });
        if !within {
            return Err(RequestError::OutsideLimits);
        }
        let pose = tool
            .geometry()
            .forward_from_directions(Vector2::unit(theta1), Vector2::unit(theta4), self.assembly)
            .map_err(|_| RequestError::NotOnBranch)?;
        // Near type 1 the joints still determine the arm's position, so it may be armed there.
        if Scalar::abs(pose.sin32()) < settings.motion.singularity_margin {
            return Err(RequestError::NearSingularity);
        }
        Ok(Stance {
            direction: [pose.u1, pose.u4],
            mode: tool.working_mode(&pose),
            shown: encoder::shown_at(settings, self.angles),
        })
    }
}

impl<D: Drives> ArmController<D> {
    /// Executes a request. Counts as a sign of life of the host.
    ///
    /// # Errors
    /// Why the request is refused; nothing has changed then.
    pub fn request(&mut self, request: Request) -> Result<(), RequestError> {
        let posture = self.posture(request);
        let stance = posture.map(|posture| posture.stance(&self.settings, &self.model.tool));
        self.execute(request, stance)
    }

    /// The joint angles that a request needs to be solved before it is executed.
    pub fn posture(&self, request: Request) -> Option<Posture> {
        let angles = match request {
            Request::Arm => self.angles(),
            Request::SetAngles(angles) => angles,
            _ => return None,
        };
        Some(Posture {
            angles,
            assembly: self.model.assembly,
        })
    }

    /// Whether the drives take power for a request.
    pub fn powers(&self, request: Request) -> bool {
        match request {
            Request::Arm | Request::Home | Request::Excite(_) => true,
            Request::SetAngles(_) => self.drives.unpowered_place() == UnpoweredPlace::Lost,
            Request::Disarm | Request::Stop | Request::EmergencyStop | Request::ClearFault => false,
        }
    }

    /// Executes a request with its solved posture, if it has one.
    ///
    /// # Errors
    /// Why the request is refused; nothing has changed then.
    pub fn execute(
        &mut self,
        request: Request,
        stance: Option<Result<Stance, RequestError>>,
    ) -> Result<(), RequestError> {
        self.feed_host_timeout();
        let stance = stance.unwrap_or(Err(RequestError::NotHomed));
        if self.powers(request) && self.state == State::Stopped && !self.drives.is_ready() {
            return Err(RequestError::CurrentZero);
        }
        // Each request has its own call, so that only its own transition is compiled behind it.
        let dispatched = match request {
            Request::Arm => {
                self.prepare_to_hold(stance)?;
                self.stay_armed();
                self.dispatch(Event::Arm)
            }
            Request::Excite(excitation) => {
                if self.state != State::Stopped {
                    return Err(RequestError::State(self.state));
                }
                self.prepare_excitation(&excitation)?;
                self.dispatch(Event::Excite)
            }
            Request::Disarm => self.switch_off(Event::Disarm),
            Request::Home => {
                self.require_rest_for_given_angles()?;
                self.dispatch(Event::Home)
            }
            Request::SetAngles(angles) => return self.set_angles(angles, stance),
            Request::Stop if self.state == State::Homing => self.switch_off(Event::Stop),
            Request::Stop => self.dispatch(Event::Stop),
            Request::EmergencyStop => {
                self.latch_fault(Fault::EmergencyStop);
                return Ok(());
            }
            Request::ClearFault if self.moves_under_fault() => return Err(RequestError::Moving),
            Request::ClearFault => self.switch_off(Event::Clear),
        };
        dispatched.map_err(RequestError::State)
    }

    /// Sets the set-point to the arm's present position, if it may be armed there. An arm that
    /// is armed already keeps its set-point.
    fn prepare_to_hold(
        &mut self,
        stance: Result<Stance, RequestError>,
    ) -> Result<(), RequestError> {
        if self.state != State::Stopped {
            return Ok(());
        }
        if !self.homed {
            return Err(RequestError::NotHomed);
        }
        let Stance {
            direction, mode, ..
        } = stance?;
        self.mode = mode;
        self.setpoint = Setpoint::hold(direction);
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

    fn set_angles(
        &mut self,
        angles: [f32; 2],
        stance: Result<Stance, RequestError>,
    ) -> Result<(), RequestError> {
        if self.state != State::Stopped {
            return Err(RequestError::State(self.state));
        }
        let stance = stance?;
        if stance.mode != self.settings.working_mode() {
            return Err(RequestError::NotOnBranch);
        }
        for ((((joint, axis), encoder), angle), shown) in self
            .joints
            .iter_mut()
            .zip(&self.model.axes)
            .zip(&mut self.encoders)
            .zip(angles)
            .zip(stance.shown)
        {
            joint.set_origin(axis, joint.counts(), angle);
            if let Some(encoder) = encoder {
                encoder.set_origin(angle, shown);
            }
        }
        self.homed = true;
        self.homed_by_index = false;
        if self.powers(Request::SetAngles(angles)) {
            self.prepare_to_hold(Ok(stance))?;
            // Stopped accepts this event.
            let _ = self.dispatch(Event::Arm);
        }
        Ok(())
    }
}
