//! The part of the tick that follows the path or holds the arm: from the reference to the
//! torques.

use super::ArmController;
use super::path::Path;
use super::setpoint::Setpoint;
use super::tick::TorqueCommand;
use crate::drives::{Drives, Needs};
use crate::safety::{Event, Fault, Limits, State};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Joint, Links, PoseError};
use fivebar_kinematics::trajectory::Reference;
use nalgebra::Vector2;

impl<D: Drives> ArmController<D> {
    /// One tick of holding or following the path: the torques.
    #[inline(always)]
    pub(super) fn track(&mut self) -> Result<TorqueCommand, Fault> {
        // Where the joints should be, and where they will be, when the torque acts.
        let limits = self.advance()?;
        self.setpoint_history.keep(&self.setpoint);
        // The field of a stepper is a spring, but no belt: its image has no such path.
        if let (Needs::Torque, true) = (D::NEEDS, self.model.on_belts) {
            let (torque, limited) = self.torques_on_belts()?;
            return Ok(TorqueCommand {
                torque,
                limits: limits.with(Limits::TORQUE, limited),
            });
        }
        let Setpoint {
            omega: [omega1d, omega4d],
            alpha: [alpha1d, alpha4d],
            ..
        } = self.setpoint;
        let [joint1, joint4] = &self.joints;
        let [axis1, axis4] = &self.model.axes;
        let (theta1, omega1) = joint1.predicted(
            axis1,
            &self
                .setpoint_history
                .between(Joint::Joint1, &axis1.servo.age),
        );
        let (theta4, omega4) = joint4.predicted(
            axis4,
            &self
                .setpoint_history
                .between(Joint::Joint4, &axis4.servo.age),
        );
        let (omega1, omega4) = (omega1d + omega1, omega4d + omega4);
        let [u1, u4] = Vector2::units([theta1, theta4]);
        let links = self.measured([u1, u4])?;
        // e = sin(θd − θ), which is the error itself as long as it is too small for a fault.
        let [d1, d4] = self.setpoint.direction;
        let (error1, error4) = (u1.cross_z(d1), u4.cross_z(d4));
        self.error = [error1, error4];
        if self.model.monitor.following_error_exceeded(self.error) {
            return Err(Fault::FollowingError);
        }

        let (rate1, rate4) = (omega1d - omega1, omega4d - omega4);
        let [joint1, joint4] = &mut self.joints;
        let [axis1, axis4] = &self.model.axes;
        let (loop1, loop4) = (&axis1.servo.position_loop, &axis4.servo.position_loop);
        let alpha = match D::NEEDS {
            Needs::Torque => {
                let times = 1.0 + self.drives.inertia_excess();
                [
                    loop1.acceleration(joint1.integral, times * alpha1d, error1, rate1),
                    loop4.acceleration(joint4.integral, times * alpha4d, error4, rate4),
                ]
            }
            // The load of the motion itself: nothing is fed back.
            Needs::Motion => [alpha1d, alpha4d],
        };
        self.rest.demanded = alpha;
        let [torque1, torque4] = if self.model.computed_torque {
            let equations = &self.model.equations;
            equations.torques(&links, [omega1, omega4], alpha)
        } else {
            // Independent joints: PID and the acceleration's feed-forward at a constant inertia.
            let [alpha1, alpha4] = alpha;
            let [inertia1, inertia4] = self.model.nominal_inertia;
            [inertia1 * alpha1, inertia4 * alpha4]
        };
        let mut demanded = [
            torque1 + axis1.friction.torque(omega1d),
            torque4 + axis4.friction.torque(omega4d),
        ];
        let (drives, path) = (&self.drives, &self.path);
        add_torques_of_path(&mut demanded, drives, path, &links, [omega1d, omega4d]);
        let (torque, limited) = self.model.torque_limit.apply(demanded);
        if let Needs::Torque = D::NEEDS {
            loop1.integrate(&mut joint1.integral, error1, limited);
            loop4.integrate(&mut joint4.integral, error4, limited);
            self.drives.follow_motion([alpha1d, alpha4d]);
        }
        Ok(TorqueCommand {
            torque,
            limits: limits.with(Limits::TORQUE, limited),
        })
    }

    /// The measured arm, if the angles belong to an arm inside its envelope.
    #[inline(always)]
    pub(super) fn measured(&self, [u1, u4]: [Vector2<f32>; 2]) -> Result<Links<f32>, Fault> {
        let monitor = &self.model.monitor;
        let geometry = self.model.tool.geometry();
        let links = geometry
            .links(u1, u4, self.model.assembly)
            .map_err(|error| match error {
                PoseError::Unreachable(_) => Fault::EncoderDisagreement,
                PoseError::Singular(_) => Fault::Envelope,
                PoseError::NotFinite => Fault::NotANumber,
            })?;
        if monitor.outside(self.angles()) || monitor.near_parallel(&links) {
            return Err(Fault::Envelope);
        }
        Ok(links)
    }

    /// Advances the set-point by one tick, and the state with it. Returns the limits that slow
    /// the reference.
    #[inline(always)]
    fn advance(&mut self) -> Result<Limits, Fault> {
        if self.state == State::Armed {
            if self.path.is_empty() {
                if !self.path.tool_is_off() && self.host_timed_out() {
                    self.forget_path();
                }
            } else if self.host_timed_out() {
                // A late planner, or bridges that wake up, have held the path back too long.
                self.forget_path();
                self.latch_fault(Fault::CommandTimeout);
            } else if self.brake.lets_move() {
                // The next tick follows the path. Armed accepts this event.
                let _ = self.dispatch(Event::Begin);
            }
            self.rest.look(self.error, &self.model);
            self.setpoint.rest();
            return Ok(Limits::empty());
        }
        let Self {
            path,
            rest,
            model,
            setpoint,
            mode,
            at_rest,
            ..
        } = self;
        let Some(step) = path.step() else {
            rest.look(self.error, model);
            setpoint.rest();
            return Ok(Limits::empty());
        };
        let reference = match step.segment.place_of_rest() {
            Some(position) => {
                rest.look(self.error, model);
                Reference::Tool {
                    position,
                    velocity: Vector2::zeros(),
                    acceleration: Vector2::zeros(),
                }
            }
            None => {
                rest.move_on();
                step.reference()
            }
        };
        *at_rest = step.at_rest;
        setpoint
            .follow(&reference, model, mode)
            .map_err(|error| match error {
                PoseError::Unreachable(_) | PoseError::Singular(_) => Fault::Envelope,
                PoseError::NotFinite => Fault::NotANumber,
            })?;
        Ok(step.limits)
    }
}

/// Adds the torques that overcome the friction of a tool that is on, at these demanded velocities of the joints [rad/s], and those
/// that a host adds.
#[inline(always)]
pub(super) fn add_torques_of_path<D: Drives>(
    [torque1, torque4]: &mut [f32; 2],
    drives: &D,
    path: &Path,
    links: &Links<f32>,
    omega: [f32; 2],
) {
    let [extra1, extra4] = path.extra_torque();
    *torque1 += extra1;
    *torque4 += extra4;
    if let Some(friction) = drives.tool_friction()
        && !path.tool_is_off()
    {
        let [of1, of4] = friction.torque(links, omega);
        *torque1 += of1;
        *torque4 += of4;
    }
}
