//! One driven joint: from the counts of its encoder to its angle and velocity.

use super::encoder::Scale;
use super::model::AxisModel;
use super::setpoint_history::Between;
use crate::drives::JointState;
use fivebar_kinematics::control::{Integral, ObserverState};

/// The state of one joint from tick to tick, and what this tick measured.
#[derive(Clone)]
#[repr(C)]
pub(crate) struct Joint {
    observer: ObserverState<f32>,
    /// Counts at the last tick.
    counts: i32,
    /// The counts from which the angle is counted: those of the first tick until homed.
    origin: i32,
    angle_at_origin: f32,
    /// Integral of the position loop.
    pub(crate) integral: Integral<f32>,
}

impl Joint {
    /// A joint at rest.
    pub(crate) fn new() -> Self {
        Self {
            counts: 0,
            origin: 0,
            angle_at_origin: 0.0,
            observer: ObserverState::at_rest(0.0),
            integral: Integral(0.0),
        }
    }

    /// θ̂ [rad], absolute only when homed.
    #[inline(always)]
    pub(crate) fn angle(&self) -> f32 {
        self.observer.angle
    }

    /// ω̂ [rad/s].
    #[inline(always)]
    pub(crate) fn velocity(&self) -> f32 {
        self.observer.velocity
    }

    /// Updates the joint from one tick's counts; `alpha` is the desired acceleration [rad/s²]
    /// of the tick before. Returns the innovation, measured less predicted angle [rad].
    #[inline(always)]
    pub(crate) fn measure(&mut self, model: &AxisModel, counts: i32, alpha: f32) -> f32 {
        self.counts = counts;
        let counted = self.counted(model);
        model
            .servo
            .observer
            .update(&mut self.observer, counted, alpha)
    }

    /// What the check of the joint's drive needs; `error` is the position error of the tick before [rad].
    #[inline(always)]
    pub(crate) fn state(&self, error: f32) -> JointState {
        JointState {
            counts: self.counts,
            velocity: self.observer.velocity,
            error,
        }
    }

    /// θ⁺ [rad] when the torque acts, and ω⁺ less the set-point's velocity then [rad/s].
    #[inline(always)]
    pub(crate) fn predicted(&self, model: &AxisModel, between: &Between) -> (f32, f32) {
        let ObserverState { angle, velocity } = self.observer;
        let position_loop = &model.servo.position_loop;
        position_loop.predict(angle + between.angle, velocity - between.omega, 0.0)
    }

    /// Takes the counts of the first tick as the origin until homed. A counter may start at any
    /// value, and `f32` angles far from 0 would lose resolution.
    #[cold]
    pub(crate) fn begin(&mut self, model: &AxisModel, counts: i32) {
        self.origin = counts;
        self.settle(model);
    }

    /// The counted angle [rad]. Counts wrap; their wrapping difference from the origin is right.
    #[inline(always)]
    pub(crate) fn counted(&self, model: &AxisModel) -> f32 {
        self.angle_at_origin + model.radians_per_count * self.turned() as f32
    }

    /// The latched counts.
    pub(crate) fn counts(&self) -> i32 {
        self.counts
    }

    /// Counts from the origin.
    #[inline(always)]
    pub(crate) fn turned(&self) -> i32 {
        self.counts.wrapping_sub(self.origin)
    }

    /// Changes the angle over the counts.
    #[inline(always)]
    pub(crate) fn set_scale(&mut self, model: &mut AxisModel, scale: Scale) {
        self.angle_at_origin = scale.at_origin;
        model.radians_per_count = scale.per_count;
    }

    /// Changes the angle over the counts of an arm that is not driven. The velocity stays.
    pub(crate) fn shift_to_scale(&mut self, model: &mut AxisModel, scale: Scale) {
        let before = self.counted(model);
        self.set_scale(model, scale);
        self.observer.angle += self.counted(model) - before;
    }

    /// Sets the origin: the joint's angle is `angle` [rad] at `counts`. The velocity stays.
    pub(crate) fn set_origin(&mut self, model: &AxisModel, counts: i32, angle: f32) {
        let before = self.counted(model);
        self.origin = counts;
        self.angle_at_origin = angle;
        self.observer.angle += self.counted(model) - before;
    }

    /// Clears the integral of the position loop: the joint is not driven.
    pub(crate) fn release(&mut self) {
        self.integral = Integral(0.0);
    }

    /// Clears all motion; keeps the counts and the origin.
    pub(crate) fn settle(&mut self, model: &AxisModel) {
        self.release();
        self.observer = ObserverState::at_rest(self.counted(model));
    }
}
