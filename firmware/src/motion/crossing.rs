//! The host's plan of a crossing, as a move.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// The tool along a line through a singularity of type 2, from rest to rest: in the time τ = t/T it has
/// the share s = 10τ³ − 15τ⁴ + 6τ⁵ + τ³(1 − τ)³ (b0 + b1 x + b2 x²) of the line behind it, x = τ − tc/T.
/// The host chooses the b so that the motion satisfies the condition of the singularity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CrossingMove {
    /// Where the line begins [m].
    pub from: [f32; 2],
    /// Where it ends [m].
    pub to: [f32; 2],
    /// T [s].
    pub duration: f32,
    /// tc, the time at which the arm is in the singularity [s].
    pub crosses_at: f32,
    /// b0, b1, b2.
    pub law: [f32; 3],
}

impl CrossingMove {
    /// s, and its first and second derivatives by τ, at a time [s].
    pub(crate) fn share(&self, time: f32) -> [f32; 3] {
        let tau = (time / self.duration).clamp(0.0, 1.0);
        let x = tau - self.crosses_at / self.duration;
        let [b0, b1, b2] = self.law;
        let (b, rate, twice) = (b0 + x * (b1 + x * b2), b1 + (b2 + b2) * x, b2 + b2);
        // τ − τ², its cube and their derivatives.
        let (g, slope) = (tau - tau * tau, 1.0 - (tau + tau));
        let (w, w_rate, w_twice) = (g * g * g, 3.0 * g * g * slope, 6.0 * g * (1.0 - 5.0 * g));
        [
            tau * tau * tau * (10.0 + tau * (6.0 * tau - 15.0)) + w * b,
            30.0 * g * g + w_rate * b + w * rate,
            60.0 * g * slope + w_twice * b + 2.0 * w_rate * rate + w * twice,
        ]
    }

    /// Position [m], velocity [m/s] and acceleration [m/s²] of the tool at a time [s].
    pub(crate) fn motion(&self, time: f32) -> [Vector2<f32>; 3] {
        let (from, to) = (Vector2::from(self.from), Vector2::from(self.to));
        let (per_time, along) = (1.0 / self.duration, to - from);
        let [s, rate, twice] = self.share(time);
        [
            from + along * s,
            along * (rate * per_time),
            along * (twice * per_time * per_time),
        ]
    }

    /// Whether all its numbers are finite.
    pub(crate) fn is_finite(&self) -> bool {
        let lists: [&[f32]; 3] = [&self.from, &self.to, &self.law];
        let finite = |list: &[f32]| list.iter().all(|value| value.is_finite());
        lists.into_iter().all(finite) && self.duration.is_finite() && self.crosses_at.is_finite()
    }
}
