//! A joint behind a belt, or another drive that stretches: an observer of both of its sides, and the feedback from them.
//!
//! With the rotor's inertia Jr at the joint, stiffness k and damping d of the belt, the load w on the links and
//! their mass matrix Ma (the rotors are not in it):
//!
//! Jr θ̈m = τ − k(θm − θ) − d(θ̇m − θ̇), Ma θ̈ = k(θm − θ) + d(θ̇m − θ̇) + w.
//!
//! Everything here is a deviation: from the motion that the set-point, and the torque fed forward for it, would
//! give. So velocity products, gravity and the known friction are not in it, and w is what the model does not
//! know. An encoder measures θm, or θ. Of its innovation r, measured less predicted,
//!
//! θm ← θm + g1 r, ωm ← ωm + g2 r, θ ← θ + g3 r, ω ← ω + Ma⁻¹ (g4 r), w ← w + g5 r.
//!
//! g4 is an impulse per angle, because Ma changes by a factor of ten and more over a workspace: the same
//! numbers then serve all poses. g5 is small: a load that is estimated fast takes the loop's margin.
//!
//! The prediction over a tick T takes the spring's impulse at its beginning, and the rotor's swing about the
//! moving joint exactly: a splitting that keeps the period and the size of a swing, and the momentum to the
//! impulse of a tick. The links are 8 times heavier than a rotor and more, so they hardly move in the swing's period:
//!
//! ω ← ω + Ma⁻¹ T (k(θm − θ) + d(ωm − ω) + w), θ ← θ + T ω,
//! (θm − θ − τ/k, ωm − ω) ← e^(AT) (θm − θ − τ/k, ωm − ω), A = [0, 1; −k/Jr, −d/Jr].
//!
//! τ follows the demand with the drive's lag; the feedback is
//!
//! α = −Kp (θ + δ ω) − Kd ω, and beside it the torque −w − c ωm,
//!
//! δ being the lag from the sample to the torque, and Kp and Kd those of [`PositionLoop`](super::PositionLoop).
//!
//! Source of the structure, an estimator with the disturbance as a state: G. Franklin, J. Powell, M. Workman,
//! Digital Control of Dynamic Systems, 3rd ed., chapter 8. The gains are searched for margins, see
//! `fivebar_design::servo`.

use super::PositionLoop;
use super::discrete::swing;
use crate::Scalar;

/// What stretches between a rotor and its joint. Angles and torques are at the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belt<S> {
    /// k [N·m/rad].
    pub stiffness: S,
    /// d [N·m·s/rad].
    pub damping: S,
    /// Jr [kg·m²].
    pub rotor_inertia: S,
    /// Whether the encoder is at the joint; else it is at the rotor.
    pub encoder_at_joint: bool,
}

/// The gains of a joint behind a belt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeltGains<S> {
    /// Bandwidth of the feedback from the links [rad/s].
    pub bandwidth: S,
    /// Its damping ratio.
    pub damping: S,
    /// c: torque against the rotor's velocity [N·m·s/rad].
    pub rotor_damping: S,
    /// g1 [1], g2 [1/s], g3 [1], g4 [N·m·s/rad], g5 [N·m/rad].
    pub observer: [S; 5],
}

/// Deviations of one joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeltState<S> {
    /// Of the rotor, θm [rad].
    pub rotor_angle: S,
    /// ωm [rad/s].
    pub rotor_velocity: S,
    /// Of the joint, θ [rad].
    pub angle: S,
    /// ω [rad/s].
    pub velocity: S,
    /// w, the unknown load on the links [N·m].
    pub load: S,
    /// τ, the torque of the drive [N·m].
    pub torque: S,
}

/// What a joint's feedback demands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeltDemand<S> {
    /// Of the links [rad/s²].
    pub alpha: S,
    /// Beside it [N·m].
    pub torque: S,
}

/// The law of one joint behind a belt.
///
/// ```
/// use fivebar_kinematics::control::{Belt, BeltGains, BeltLaw, BeltState};
///
/// // A rotor of 64 mg·m² behind 2500 N·m/rad drives links of 0.9 g·m²; 10 kHz, a lag of 0.3 ms.
/// let belt = Belt { stiffness: 2500.0, damping: 8e-3, rotor_inertia: 6.4e-5, encoder_at_joint: false };
/// let gains = BeltGains {
///     bandwidth: 200.0, damping: 0.7, rotor_damping: 0.01, observer: [0.17, 25.0, 0.055, 0.04, 9.0],
/// };
/// let law = BeltLaw::new(&belt, &gains, 3e-4, 3e-4, 1e-4);
/// // The observer finds a load of 10 mN·m on the links from the rotor's angle alone: here the rotor is held.
/// let (mut state, inertia) = (BeltState::default(), 9e-4_f64);
/// for _ in 0..20_000 {
///     let impulse = law.correct(&mut state, 0.0, 0.0);
///     state.velocity += impulse / inertia;
///     // The torque that holds the rotor.
///     let change = law.impulse(&state) / inertia;
///     law.advance(&mut state, change, -0.01);
/// }
/// assert!((state.load - 0.01).abs() < 1e-4);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeltLaw<S> {
    period: S,
    stiffness: S,
    damping: S,
    per_stiffness: S,
    encoder_at_joint: bool,
    /// e^(AT), by rows.
    swing: [[S; 2]; 2],
    /// The share of the change of the demand that the torque makes in a tick.
    follows: S,
    observer: [S; 5],
    /// Kp, and Kd + δ Kp.
    angle_gain: S,
    velocity_gain: S,
    rotor_damping: S,
}

impl<S: Scalar> BeltLaw<S> {
    /// The law of a joint whose torque follows its demand with the lag `drive_lag` [s], the tick of delay in it,
    /// and acts δ = `lag` [s] after the sample of the angle; in ticks of `period` T [s].
    pub fn new(belt: &Belt<S>, gains: &BeltGains<S>, drive_lag: S, lag: S, period: S) -> Self {
        let Belt {
            stiffness,
            damping,
            rotor_inertia,
            encoder_at_joint,
        } = *belt;
        let position = PositionLoop::new(gains.bandwidth, gains.damping, lag, S::ZERO, period);
        // A first-order lag behind a tick of delay: both together are the drive's lag.
        let ticks = drive_lag / period - S::ONE;
        Self {
            period,
            stiffness,
            damping,
            per_stiffness: S::ONE / stiffness,
            encoder_at_joint,
            swing: swing(stiffness / rotor_inertia, damping / rotor_inertia, period),
            follows: if ticks > S::ONE {
                S::ONE / ticks
            } else {
                S::ONE
            },
            observer: gains.observer,
            angle_gain: position.kp(),
            velocity_gain: position.kd() + lag * position.kp(),
            rotor_damping: gains.rotor_damping,
        }
    }

    /// What the encoder's angle leads θ by where this torque [N·m] passes the belt [rad].
    #[inline(always)]
    pub fn lead(&self, torque: S) -> S {
        if self.encoder_at_joint {
            S::ZERO
        } else {
            self.per_stiffness * torque
        }
    }

    /// Corrects the state by the measured deviation of the encoder's angle [rad]; what is left is the impulse on
    /// the links that it gives [N·m·s]. `unseen` is how far the angle may be from the measured one without another
    /// count [rad]: half a count at rest, where one count would be corrected for ever and the arm would chatter; 0
    /// in motion, where the counts are right in the mean.
    #[inline(always)]
    pub fn correct(&self, state: &mut BeltState<S>, measured: S, unseen: S) -> S {
        let [g1, g2, g3, g4, g5] = self.observer;
        let predicted = if self.encoder_at_joint {
            state.angle
        } else {
            state.rotor_angle
        };
        let apart = measured - predicted;
        let r = if apart > unseen {
            apart - unseen
        } else if apart < -unseen {
            apart + unseen
        } else {
            S::ZERO
        };
        state.rotor_angle += g1 * r;
        state.rotor_velocity += g2 * r;
        state.angle += g3 * r;
        state.load += g5 * r;
        g4 * r
    }

    /// What the feedback demands in this state.
    #[inline(always)]
    pub fn demand(&self, state: &BeltState<S>) -> BeltDemand<S> {
        BeltDemand {
            alpha: -(self.angle_gain * state.angle + self.velocity_gain * state.velocity),
            torque: -(state.load + self.rotor_damping * state.rotor_velocity),
        }
    }

    /// The impulse on the links over the next tick [N·m·s].
    #[inline(always)]
    pub fn impulse(&self, state: &BeltState<S>) -> S {
        let BeltState {
            rotor_angle,
            rotor_velocity,
            angle,
            velocity,
            load,
            ..
        } = *state;
        self.period
            * (self.stiffness * (rotor_angle - angle)
                + self.damping * (rotor_velocity - velocity)
                + load)
    }

    /// Predicts the next sample: the links' velocity changes by `change` [rad/s], and the drive's torque goes towards
    /// `demand` [N·m], the deviation demanded a tick, and the encoder's latency, before.
    #[inline(always)]
    pub fn advance(&self, state: &mut BeltState<S>, change: S, demand: S) {
        let torque = state.torque + self.follows * (demand - state.torque);
        let twist = self.per_stiffness * S::HALF * (state.torque + torque);
        let velocity = state.velocity + change;
        let angle = state.angle + self.period * velocity;
        let apart = state.rotor_angle - state.angle - twist;
        let rate = state.rotor_velocity - velocity;
        let [[a11, a12], [a21, a22]] = self.swing;
        *state = BeltState {
            rotor_angle: angle + twist + a11 * apart + a12 * rate,
            rotor_velocity: velocity + a21 * apart + a22 * rate,
            angle,
            velocity,
            load: state.load,
            torque,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(encoder_at_joint: bool) -> BeltLaw<f64> {
        let belt = Belt {
            stiffness: 1000.0,
            damping: 0.0,
            rotor_inertia: 1e-4,
            encoder_at_joint,
        };
        let gains = BeltGains {
            bandwidth: 100.0,
            damping: 0.7,
            rotor_damping: 0.0,
            observer: [0.5, 10.0, 0.25, 0.125, 2.0],
        };
        BeltLaw::new(&belt, &gains, 3e-4, 3e-4, 1e-4)
    }

    #[test]
    fn the_innovation_is_that_of_the_side_with_the_encoder() {
        let state = BeltState {
            rotor_angle: 3.0,
            angle: 1.0,
            ..BeltState::default()
        };
        for (encoder_at_joint, innovation) in [(false, 1.0), (true, 3.0)] {
            let mut corrected = state;
            let impulse = law(encoder_at_joint).correct(&mut corrected, 4.0, 0.0);
            assert_eq!(impulse, 0.125 * innovation);
            let expected = BeltState {
                rotor_angle: 3.0 + 0.5 * innovation,
                rotor_velocity: 10.0 * innovation,
                angle: 1.0 + 0.25 * innovation,
                load: 2.0 * innovation,
                ..state
            };
            assert_eq!(corrected, expected);
        }
    }

    #[test]
    fn a_free_swing_keeps_its_period_its_size_and_its_momentum() {
        let (law, inertia, rotor) = (law(false), 2e-3, 1e-4);
        let mut state = BeltState {
            rotor_angle: 1e-3,
            ..BeltState::default()
        };
        // √(k (1/Jr + 1/J)).
        let rate = f64::sqrt(1000.0 * (1.0 / rotor + 1.0 / inertia));
        let (mut turns, mut apart, mut size) = (0, 1e-3, 0.0_f64);
        for tick in 0..10_000 {
            let change = law.impulse(&state) / inertia;
            law.advance(&mut state, change, 0.0);
            let now = state.rotor_angle - state.angle;
            turns += usize::from(apart < 0.0 && now >= 0.0);
            apart = now;
            if tick >= 9_800 {
                size = size.max(now.abs());
            }
        }
        let momentum = rotor * state.rotor_velocity + inertia * state.velocity;
        // Of a tick: k · 1 mrad · T.
        assert!(momentum.abs() < 1e-4, "{momentum}");
        assert!((size / 1e-3 - 1.0).abs() < 0.01, "{size}");
        // In a second.
        let swings = turns as f64 / (rate / core::f64::consts::TAU);
        assert!((swings - 1.0).abs() < 0.005, "{swings}");
    }
}
