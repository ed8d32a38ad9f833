//! Requests from below the tick, and why they are refused.

use super::{Controller, Setpoint};
use crate::safety::{Event, Fault, State};
use fivebar_kinematics::five_bar::Pose;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// What the controller can be asked for, besides moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Request {
    /// Power the bridges and hold.
    Arm,
    /// Unpower the bridges.
    Disarm,
    /// Find the joint angles by driving to the home switches.
    Home,
    /// Take the joint angles to be θ1, θ4 [rad], here and now.
    SetAngles([f32; 2]),
    /// Come to rest on the path, forget the rest of it and hold.
    Stop,
    /// Unpower the bridges at once and latch the fault.
    EmergencyStop,
    /// Leave the fault.
    ClearFault,
}

/// Why a request was refused. Nothing has changed then.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// The state does not allow it.
    State(State),
    /// The joint angles are not known: home first.
    NotHomed,
    /// A joint is outside its limits.
    OutsideLimits,
    /// The arm is too near a singularity.
    NearSingularity,
    /// The angles close no arm on the branch of the settings.
    NotOnBranch,
    /// The arm still moves.
    Moving,
}

impl core::fmt::Display for Refusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::State(state) => return write!(f, "it is not possible while {state:?}"),
            Self::NotHomed => "the joint angles are not known: home first",
            Self::OutsideLimits => "a joint is outside its limits",
            Self::NearSingularity => "the arm is too near a singularity",
            Self::NotOnBranch => "the angles close no arm on the branch of the settings",
            Self::Moving => "the arm still moves",
        })
    }
}

impl core::error::Error for Refusal {}

impl Controller {
    /// Does what is asked, or says why not. Counts as a sign of life of the host.
    ///
    /// # Errors
    /// The reason, nothing having changed.
    pub fn request(&mut self, request: Request) -> Result<(), Refusal> {
        self.feed_host_timeout();
        let event = match request {
            Request::Arm => {
                self.prepare_to_hold()?;
                Event::Arm
            }
            Request::Disarm => Event::Disarm,
            Request::Home => Event::Home,
            Request::SetAngles(angles) => return self.set_angles(angles),
            Request::Stop => Event::Stop,
            Request::EmergencyStop => {
                self.latch_fault(Fault::EmergencyStop);
                return Ok(());
            }
            Request::ClearFault if self.moves_under_fault() => return Err(Refusal::Moving),
            Request::ClearFault => Event::Clear,
        };
        self.dispatch(event).map_err(Refusal::State)
    }

    /// Takes where the arm stands for its set-point, if it may be armed there. One that is
    /// armed already keeps its own.
    fn prepare_to_hold(&mut self) -> Result<(), Refusal> {
        if self.state != State::Stopped {
            return Ok(());
        }
        if !self.homed {
            return Err(Refusal::NotHomed);
        }
        let pose = self.standing(self.angles())?;
        self.mode = self.model.tool.working_mode(&pose);
        self.setpoint = Setpoint::hold([pose.u1, pose.u4]);
        Ok(())
    }

    fn set_angles(&mut self, angles: [f32; 2]) -> Result<(), Refusal> {
        if self.state != State::Stopped {
            return Err(Refusal::State(self.state));
        }
        let pose = self.standing(angles)?;
        if self.model.tool.working_mode(&pose) != self.settings.working_mode() {
            return Err(Refusal::NotOnBranch);
        }
        for ((joint, axis), angle) in self.joints.iter_mut().zip(&self.model.axes).zip(angles) {
            joint.set_origin(axis, joint.counts(), angle);
        }
        self.homed = true;
        Ok(())
    }

    /// The pose at these joint angles [rad], if the arm may be armed there.
    fn standing(&self, [theta1, theta4]: [f32; 2]) -> Result<Pose<f32>, Refusal> {
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
            return Err(Refusal::OutsideLimits);
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
            .map_err(|_| Refusal::NotOnBranch)?;
        // Type 1 is no danger to an arm that is held or moved by its joints.
        if Scalar::abs(pose.sin32()) < settings.motion.singularity_margin {
            return Err(Refusal::NearSingularity);
        }
        Ok(pose)
    }
}
