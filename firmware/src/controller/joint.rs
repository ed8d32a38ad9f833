//! One driven joint: from raw samples to its angle, velocity and current, and from a
//! torque to its bridge's duty.

use super::model::AxisModel;
use fivebar_kinematics::control::{CurrentState, Drive, Integral, MotorHeat, ObserverState};

/// What one joint remembers from tick to tick, and what this tick measured.
pub(crate) struct Joint {
    /// Counts at the tick before; none before the first tick.
    counts: Option<i32>,
    /// The angle `angle_at_origin` belongs to these counts; the first ones until homed.
    origin: i32,
    angle_at_origin: f32,
    observer: ObserverState<f32>,
    heat: MotorHeat<f32>,
    current_state: CurrentState<f32>,
    /// Integral of the position loop.
    pub(crate) integral: Integral<f32>,
    /// The desired acceleration that gets through the current loop's lag now [rad/s²].
    acting: f32,
    /// θ̂ [rad], absolute only when homed.
    pub(crate) angle: f32,
    /// Motor current [A].
    pub(crate) current: f32,
    /// Current set-point [A].
    pub(crate) demand: f32,
    /// Duty of the bridge.
    pub(crate) duty: f32,
}

/// What a tick's samples say of a joint besides its state.
pub(crate) struct Sample {
    /// Measured less predicted angle [rad].
    pub(crate) innovation: f32,
    /// The I²t model's verdict.
    pub(crate) too_hot: bool,
}

impl Joint {
    pub(crate) fn new() -> Self {
        Self {
            counts: None,
            origin: 0,
            angle_at_origin: 0.0,
            observer: ObserverState::at_rest(),
            heat: MotorHeat::cold(),
            current_state: CurrentState(0.0),
            integral: Integral(0.0),
            acting: 0.0,
            angle: 0.0,
            current: 0.0,
            demand: 0.0,
            duty: 0.0,
        }
    }

    /// ω̂ [rad/s].
    #[inline]
    pub(crate) fn velocity(&self) -> f32 {
        self.observer.velocity
    }

    /// Takes in one tick's samples; `alpha` is the desired acceleration [rad/s²] of the
    /// tick before.
    #[inline]
    pub(crate) fn measure(
        &mut self,
        model: &AxisModel,
        counts: i32,
        current: u16,
        alpha: f32,
    ) -> Sample {
        let before = self.counts.unwrap_or_else(|| {
            // A counter may stand anywhere at first. Angles are told from there until
            // homed, so that `f32` has its digits left for the motion.
            self.origin = counts;
            counts
        });
        let delta = counts.wrapping_sub(before);
        self.counts = Some(counts);
        self.acting += model.passing * (alpha - self.acting);
        let innovation = model
            .observer
            .update(&mut self.observer, delta as f32, self.acting);
        self.angle = self.estimate(model);
        self.current = model.current_offset + model.current_per_code * f32::from(current);
        Sample {
            innovation,
            too_hot: model.heating.update(&mut self.heat, self.current),
        }
    }

    /// The duty that brings the current to what `torque` [N·m] needs; true if the bus
    /// could not.
    #[inline]
    pub(crate) fn drive(&mut self, model: &AxisModel, torque: f32, bus: f32, per_bus: f32) -> bool {
        self.demand = torque * model.current_per_torque;
        let Drive { duty, limited } = model.current_loop.update(
            &mut self.current_state,
            self.demand,
            self.current,
            self.observer.velocity,
            bus,
            per_bus,
        );
        self.duty = duty;
        limited
    }

    /// θ̂ [rad] by the counts and what the observer adds to them.
    #[inline]
    fn estimate(&self, model: &AxisModel) -> f32 {
        let turned = self.counts.unwrap_or(0).wrapping_sub(self.origin);
        self.angle_at_origin + model.radians_per_count * turned as f32 + self.observer.offset
    }

    /// The latched counts.
    pub(crate) fn counts(&self) -> i32 {
        self.counts.unwrap_or(0)
    }

    /// Declares that the joint's angle is `angle` [rad] where its counts are `counts`.
    pub(crate) fn set_origin(&mut self, model: &AxisModel, counts: i32, angle: f32) {
        self.origin = counts;
        self.angle_at_origin = angle;
        self.angle = self.estimate(model);
    }

    /// Forgets the loops' integrals and outputs: the bridge is off.
    pub(crate) fn release(&mut self) {
        self.current_state = CurrentState(0.0);
        self.integral = Integral(0.0);
        self.demand = 0.0;
        self.duty = 0.0;
    }

    /// Forgets all motion, the counts and the origin excepted.
    pub(crate) fn settle(&mut self) {
        self.release();
        self.observer = ObserverState::at_rest();
        self.acting = 0.0;
    }
}
