//! The controller's status, computed when it is asked for and outside the tick.
//!
//! A reader locks the controller while it copies [`StatusSample`], and solves the poses in it
//! afterwards: the tick does not wait for that.

use super::crossing::PlanPlace;
use super::setpoint::Setpoint;
use super::{ArmController, JointReference, Snapshot, Status};
use crate::drives::Drives;
use crate::safety::State;
use crate::settings::{Settings, Share};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Side, Tool, WorkingMode};
use nalgebra::Vector2;

/// The status with its poses still to be solved.
#[derive(Clone, Copy, Debug)]
pub struct StatusSample {
    /// Without `tool`, `tool_level` and the references.
    status: Status,
    reference: Option<ReferenceNow>,
    tool_output: Share,
    assembly: Side,
}

/// Where the joints should be now.
#[derive(Clone, Copy, Debug)]
enum ReferenceNow {
    /// This set-point leads by the drives' lag [s].
    Ahead { setpoint: Setpoint, lag: f32 },
    /// On the plan of a crossing.
    Planned(PlanPlace),
}

impl<D: Drives> ArmController<D> {
    /// Ticks since the reset.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// Its drives.
    #[inline(always)]
    pub fn drives(&self) -> &D {
        &self.drives
    }

    /// The controller after the last tick.
    pub fn status(&self) -> Status {
        self.status_sample().solve(&self.settings, &self.model.tool)
    }

    /// A copy of what the status needs.
    pub fn status_sample(&self) -> StatusSample {
        let reference = self.is_powered().then(|| match self.state {
            State::Crossing => ReferenceNow::Planned(self.crossing_reference()),
            _ => ReferenceNow::Ahead {
                setpoint: self.setpoint,
                lag: self.model.lag,
            },
        });
        let drives = self.drives.report();
        let status = Status {
            tick: self.ticks,
            missed_ticks: self.missed_ticks,
            state: self.state,
            fault: self.latched.as_ref().map(|latched| latched.fault),
            limits: self.limits,
            homed: self.homed,
            angle: self.angles(),
            velocity: self.velocities(),
            tool: None,
            reference: None,
            joint_reference: None,
            torque: self.torques(),
            current_demand: drives.current_demand,
            current: drives.current,
            duty: drives.duty,
            bus_voltage: drives.bus_voltage,
            tag: self.crossing_tag().or_else(|| self.path.tag()),
            tool_level: 0.0,
        };
        StatusSample {
            status,
            reference,
            tool_output: self.path.tool_output(),
            assembly: self.model.assembly,
        }
    }

    /// The controller's state.
    pub fn state(&self) -> State {
        self.state
    }

    /// The working mode that the arm is in.
    pub fn working_mode(&self) -> WorkingMode {
        self.mode
    }

    /// The latched fault, with the measured values of the tick that raised it.
    pub fn fault(&self) -> Option<Snapshot> {
        let latched = self.latched.as_ref()?;
        let [joint1, joint4] = &latched.joints;
        let drives = &latched.drives;
        Some(Snapshot {
            fault: latched.fault,
            tick: latched.tick,
            state: latched.state,
            angle: [joint1.angle, joint4.angle],
            velocity: [joint1.velocity, joint4.velocity],
            error: latched.error,
            current: drives.current,
            torque: self.drives.torque(drives.current_demand),
            bus_voltage: drives.bus_voltage,
        })
    }
}

impl StatusSample {
    /// The status of the arm of these settings, with this tool.
    pub fn solve(&self, settings: &Settings, tool: &Tool<f32>) -> Status {
        let Status { homed, angle, .. } = self.status;
        let reference = self.reference.map(ReferenceNow::setpoint);
        Status {
            tool: homed
                .then(|| self.tool_at(tool, angle.map(Vector2::unit)))
                .flatten(),
            reference: reference.and_then(|now| self.tool_at(tool, now.direction)),
            joint_reference: reference.map(|now| JointReference {
                angle: now.direction.map(Vector2::polar_angle),
                velocity: now.omega,
                acceleration: now.alpha,
            }),
            tool_level: settings.tool_output.level(self.tool_output),
            ..self.status
        }
    }

    /// The tool [m] with the driven links in these directions.
    fn tool_at(&self, tool: &Tool<f32>, [u1, u4]: [Vector2<f32>; 2]) -> Option<[f32; 2]> {
        let pose = tool
            .geometry()
            .forward_from_directions(u1, u4, self.assembly)
            .ok()?;
        let point = tool.point(&pose);
        Some([point.x, point.y])
    }
}

impl ReferenceNow {
    /// A set-point that leads by the lag d is turned back by ω d − ½ α d².
    fn setpoint(self) -> Setpoint {
        match self {
            Self::Planned(place) => place.setpoint(),
            Self::Ahead { setpoint, lag } => {
                let Setpoint {
                    direction: [d1, d4],
                    omega: [omega1, omega4],
                    alpha: [alpha1, alpha4],
                } = setpoint;
                let back = |direction: Vector2<f32>, omega: f32, alpha: f32| {
                    direction.to_base_frame(Vector2::unit(-lag * (omega - 0.5 * lag * alpha)))
                };
                Setpoint {
                    direction: [back(d1, omega1, alpha1), back(d4, omega4, alpha4)],
                    ..setpoint
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Controller;
    use crate::Settings;

    /// A joint at θ with ω and α passed θ − ω d + ½ α d² the time d ago.
    #[test]
    fn the_reference_is_where_the_set_point_was_a_lag_ago() {
        let settings = Settings::BENCHTOP.check().expect("valid settings");
        let mut controller = Controller::new(&settings);
        let (angle, omega, alpha) = ([2.0_f32, 1.0], [3.0, -4.0], [900.0, -700.0]);
        controller.setpoint.direction = angle.map(Vector2::unit);
        controller.setpoint.omega = omega;
        controller.setpoint.alpha = alpha;
        let d = controller.model.lag;
        assert!(d > 1e-4, "{d} s");
        let now = ReferenceNow::Ahead {
            setpoint: controller.setpoint,
            lag: d,
        };
        let found = now.setpoint().direction.map(Vector2::polar_angle);
        for (((found, angle), omega), alpha) in found.into_iter().zip(angle).zip(omega).zip(alpha) {
            let expected = angle - omega * d + 0.5 * alpha * d * d;
            assert!((found - expected).abs() < 5e-7, "{found} for {expected}");
        }
    }
}
