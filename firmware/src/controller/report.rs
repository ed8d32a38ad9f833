//! The controller's status, computed when it is asked for and outside the tick.

use super::setpoint::Setpoint;
use super::{ArmController, JointReference, Snapshot, Status};
use crate::drives::Drives;
use crate::safety::State;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::WorkingMode;
use nalgebra::Vector2;

impl<D: Drives> ArmController<D> {
    /// Ticks since the reset.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// The controller after the last tick.
    pub fn status(&self) -> Status {
        let drives = self.drives.report();
        let reference = self.is_powered().then(|| self.reference_now());
        Status {
            tick: self.ticks,
            missed_ticks: self.missed_ticks,
            state: self.state,
            fault: self.latched.as_ref().map(|latched| latched.fault),
            limits: self.limits,
            homed: self.homed,
            angle: self.angles(),
            velocity: self.velocities(),
            tool: self
                .homed
                .then(|| self.tool_at(self.angles().map(Vector2::unit)))
                .flatten(),
            reference: reference.and_then(|now| self.tool_at(now.direction)),
            joint_reference: reference.map(|now| JointReference {
                angle: now.direction.map(Vector2::polar_angle),
                velocity: now.omega,
                acceleration: now.alpha,
            }),
            torque: self.torques(),
            current_demand: drives.current_demand,
            current: drives.current,
            duty: drives.duty,
            bus_voltage: drives.bus_voltage,
            tag: self.crossing_tag().or_else(|| self.path.tag()),
            tool_level: self.settings.tool_output.level(self.path.tool_output()),
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

    /// Where the joints should be now: the set-point leads by the drives' lag d, so it
    /// is turned back by ω d − ½ α d².
    fn reference_now(&self) -> Setpoint {
        if self.state == State::Crossing {
            return self.crossing_reference();
        }
        let lag = self.model.lag;
        let Setpoint {
            direction: [d1, d4],
            omega: [omega1, omega4],
            alpha: [alpha1, alpha4],
        } = self.setpoint;
        let back = |direction: Vector2<f32>, omega: f32, alpha: f32| {
            direction.to_base_frame(Vector2::unit(-lag * (omega - 0.5 * lag * alpha)))
        };
        Setpoint {
            direction: [back(d1, omega1, alpha1), back(d4, omega4, alpha4)],
            ..self.setpoint
        }
    }

    /// The tool [m] with the driven links in these directions.
    fn tool_at(&self, [u1, u4]: [Vector2<f32>; 2]) -> Option<[f32; 2]> {
        let geometry = self.model.tool.geometry();
        let pose = geometry
            .forward_from_directions(u1, u4, self.model.assembly)
            .ok()?;
        let point = self.model.tool.point(&pose);
        Some([point.x, point.y])
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
        let found = controller
            .reference_now()
            .direction
            .map(Vector2::polar_angle);
        for (((found, angle), omega), alpha) in found.into_iter().zip(angle).zip(omega).zip(alpha) {
            let expected = angle - omega * d + 0.5 * alpha * d * d;
            assert!((found - expected).abs() < 5e-7, "{found} for {expected}");
        }
    }
}
