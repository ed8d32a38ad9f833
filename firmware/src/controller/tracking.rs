//! The part of the tick that follows the path or holds the arm: from the reference to the
//! torques.

use super::Controller;
use super::setpoint::Setpoint;
use super::tick::TorqueCommand;
use crate::safety::{Event, Fault, Limits, State};
use fivebar_kinematics::control::Integral;
use fivebar_kinematics::five_bar::{Links, PoseError};
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

impl Controller {
    /// One tick of holding or following the path: the torques.
    #[inline(always)]
    pub(super) fn track(&mut self) -> Result<TorqueCommand, Fault> {
        // Where the joints should be, and where they will be, when the torque acts.
        let limits = self.advance()?;
        let Setpoint {
            omega: [omega1d, omega4d],
            alpha: [alpha1d, alpha4d],
            of_joints,
            ..
        } = self.setpoint;
        let [joint1, joint4] = &self.joints;
        let [axis1, axis4] = &self.model.axes;
        let (loop1, loop4) = (&axis1.servo.position_loop, &axis4.servo.position_loop);
        let (theta1, omega1) = loop1.predict(joint1.angle(), joint1.velocity(), alpha1d);
        let (theta4, omega4) = loop4.predict(joint4.angle(), joint4.velocity(), alpha4d);
        let (u1, u4) = (Vector2::unit(theta1), Vector2::unit(theta4));
        let links = self.measured([u1, u4])?;
        if of_joints {
            // A joint move may change the working mode.
            let pose = self.model.tool.geometry().pose(&links);
            self.mode = self.model.tool.working_mode(&pose);
        }
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
        let alpha1 = loop1.acceleration(joint1.integral, alpha1d, error1, rate1);
        let alpha4 = loop4.acceleration(joint4.integral, alpha4d, error4, rate4);
        let alpha = [alpha1, alpha4];
        let [torque1, torque4] = if self.model.computed_torque {
            let equations = &self.model.equations;
            equations.torques(&links, [omega1, omega4], alpha)
        } else {
            // Independent joints: PID and the acceleration's feed-forward at a constant inertia.
            let [inertia1, inertia4] = self.model.nominal_inertia;
            [inertia1 * alpha1, inertia4 * alpha4]
        };
        let demanded = [
            torque1 + axis1.friction.torque(omega1d),
            torque4 + axis4.friction.torque(omega4d),
        ];
        let (torque, limited) = self.model.torque_limit.apply(demanded);
        loop1.integrate(&mut joint1.integral, error1, limited);
        loop4.integrate(&mut joint4.integral, error4, limited);
        self.look_for_rest(alpha);
        Ok(TorqueCommand {
            torque,
            limits: limits.with(Limits::TORQUE, limited),
        })
    }

    /// Counts the ticks for which the reference has been at rest and the joints near it. An arm
    /// that begins to rest goes on with the mean of the accelerations demanded meanwhile, `alpha`
    /// [rad/s²] being this tick's: under a load its torque stays.
    #[inline(always)]
    fn look_for_rest(&mut self, alpha: [f32; 2]) {
        let Setpoint {
            omega,
            alpha: of_path,
            ..
        } = self.setpoint;
        if omega != [0.0; 2] || of_path != [0.0; 2] {
            return self.move_on();
        }
        let rests = self.still >= self.model.rest_ticks;
        let [axis1, axis4] = &self.model.axes;
        let [error1, error4] = self.error;
        let near = Scalar::abs(error1) <= axis1.rest_error[usize::from(rests)]
            && Scalar::abs(error4) <= axis4.rest_error[usize::from(rests)];
        if !near {
            return self.move_on();
        }
        if rests {
            return;
        }
        let [sum1, sum4] = &mut self.demanded;
        *sum1 += alpha[0];
        *sum4 += alpha[1];
        self.still += 1;
        if self.still == self.model.rest_ticks {
            self.come_to_hold();
        }
    }

    /// The arm rests from now on.
    #[cold]
    #[inline(never)]
    fn come_to_hold(&mut self) {
        for (joint, sum) in self.joints.iter_mut().zip(self.demanded) {
            joint.integral = Integral(sum * self.model.per_rest_tick);
        }
        self.model.select_servos(true);
    }

    /// The arm does not rest.
    #[inline(always)]
    pub(super) fn move_on(&mut self) {
        if self.still == 0 {
            return;
        }
        self.leave_rest();
    }

    #[cold]
    #[inline(never)]
    fn leave_rest(&mut self) {
        if self.still >= self.model.rest_ticks {
            self.model.select_servos(false);
        }
        self.still = 0;
        self.demanded = [0.0; 2];
    }

    /// The measured arm, if the angles belong to an arm inside its envelope.
    #[inline(always)]
    fn measured(&self, [u1, u4]: [Vector2<f32>; 2]) -> Result<Links<f32>, Fault> {
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
                self.setpoint.rest();
                return Ok(Limits::empty());
            }
            // Armed accepts this event.
            let _ = self.dispatch(Event::Begin);
        }
        let Some(step) = self.path.step() else {
            self.setpoint.rest();
            return Ok(Limits::empty());
        };
        self.setpoint
            .follow(&step.reference, &self.model, self.mode)
            .map_err(|error| match error {
                PoseError::Unreachable(_) | PoseError::Singular(_) => Fault::Envelope,
                PoseError::NotFinite => Fault::NotANumber,
            })?;
        if step.at_rest {
            self.setpoint.rest();
            self.at_rest = true;
        }
        Ok(step.limits)
    }
}
