//! The resistance of the supply.
//!
//! i = d₁ i₁ + d₄ i₄
//! V = V₀ − R i
//! uⱼ = dⱼ V
//!
//! dⱼ is the duty of a bridge, iⱼ its motor's current: a bridge takes the power that it gives,
//! V d i = u i. A motor that brakes returns current, i < 0, which raises the bus above V₀: the
//! supply is a battery, or has a brake resistor that is equal to its own resistance. There is no
//! capacitor; one of C would follow this voltage with the time constant R C.

use fivebar_kinematics::five_bar::Joint;

/// The supply and its leads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Supply {
    /// R [Ω].
    pub(crate) resistance: f64,
}

impl Supply {
    /// i [A]; a bridge that is off takes nothing.
    #[inline]
    pub(crate) fn current(duty: [Option<f64>; 2], current: [f64; 2]) -> f64 {
        let taken = |j: Joint| duty[j].map_or(0.0, |duty| duty * current[j]);
        let [taken1, taken4] = Joint::ALL.map(taken);
        taken1 + taken4
    }

    /// V₀ − V [V].
    #[inline]
    pub(crate) fn drop(self, duty: [Option<f64>; 2], current: [f64; 2]) -> f64 {
        self.resistance * Self::current(duty, current)
    }
}
