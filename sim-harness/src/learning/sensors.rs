//! Where the tool is as the sensors see it: from the encoders' angles, their declared latency, and the stretch of
//! declared belts under the torque that was demanded.

use super::LearningError;
use fivebar_files::robot::Robot;
use fivebar_firmware::Status;
use fivebar_kinematics::five_bar::{Joint, Side, Tool};
use fivebar_plant::EncoderSide;
use nalgebra::Vector2;
use std::collections::VecDeque;

/// What is known of a drive.
#[derive(Clone, Copy, Debug)]
struct Drive {
    /// How far the encoder leads the joint per torque that passes the belt [rad/(N·m)].
    compliance: f64,
    /// At the joint [kg·m²].
    rotor_inertia: f64,
    /// Ticks from the moment of an angle to that of its sample.
    latency: f64,
}

/// The sensors of an arm, tick by tick.
#[derive(Clone, Debug)]
pub(super) struct Sensors {
    tool: Tool<f64>,
    assembly: Side,
    drives: [Drive; 2],
    /// Ticks until a demanded torque acts.
    lag: f64,
    /// The leads that were demanded [rad], the newest first.
    leads: VecDeque<[f64; 2]>,
}

impl Sensors {
    pub(super) fn new(robot: &Robot) -> Result<Self, LearningError> {
        let rate = robot.control.tick_rate;
        let actuators = robot.actuators.unwrap_or(robot.drives()?);
        let lag = rate / robot.gains().current_bandwidth;
        let drives = actuators.map(|actuator| Drive {
            compliance: match (actuator.stiffness, actuator.encoder_side) {
                (Some(stiffness), EncoderSide::Motor) => 1.0 / stiffness,
                _ => 0.0,
            },
            rotor_inertia: actuator.motor().reflected_inertia(),
            latency: rate * actuator.encoder_latency,
        });
        Ok(Self {
            tool: robot.tool_on_link()?,
            assembly: robot.home_pose()?.assembly(),
            drives,
            lag,
            leads: VecDeque::new(),
        })
    }

    /// Ticks from the moment that a sample shows to the sample itself.
    pub(super) fn latency(&self) -> f64 {
        0.5 * (self.drives[0].latency + self.drives[1].latency)
    }

    /// The tool at the moment that this tick's sample shows [m]; none while the angles belong to no arm.
    pub(super) fn tool(&mut self, status: &Status) -> Option<Vector2<f64>> {
        let alpha = status.joint_reference?.acceleration;
        let lead = |joint: Joint| {
            let drive = &self.drives[joint];
            let torque = f64::from(status.torque[joint]);
            drive.compliance * (torque - drive.rotor_inertia * f64::from(alpha[joint]))
        };
        let kept = (self.lag + self.latency()).ceil() as usize + 1;
        self.leads.push_front(Joint::ALL.map(lead));
        self.leads.truncate(kept + 1);
        let angle = |joint: Joint| {
            let age = (self.lag + self.drives[joint].latency).round() as usize;
            let lead = self.leads.get(age).or(self.leads.back());
            f64::from(status.angle[joint]) - lead.map_or(0.0, |lead| lead[joint])
        };
        let [theta1, theta4] = Joint::ALL.map(angle);
        let pose = self.tool.geometry().forward(theta1, theta4, self.assembly);
        Some(self.tool.point(&pose.ok()?))
    }
}
