//! Backlash: a dead zone in the drive's spring.
//!
//! y = x − g/2 for x > g/2, x + g/2 for x < −g/2, else 0, with the full gap g;
//! τ = k y + d ẋ |y|/(|y| + y₀), and τ y ≥ 0.
//!
//! The dead zone is the one of Nordin and Gutman, Controlling mechanical systems with backlash,
//! Automatica 38 (2002). There the damping acts in full as soon as the flanks touch, so that the
//! torque jumps and may pull. Here it grows with the depth y over y₀ = g/20, as in the contact law
//! of Hunt and Crossley (1975), and flanks that part do not pull.

/// The gap between a rotor and its joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Backlash {
    /// g/2 [rad].
    half: f64,
    /// Depth y₀ at which half of the damping acts [rad].
    depth: f64,
}

/// y₀ as a share of the gap.
const DEPTH: f64 = 0.05;

impl Backlash {
    /// A full gap g [rad].
    pub(crate) fn new(gap: f64) -> Self {
        Self {
            half: 0.5 * gap,
            depth: DEPTH * gap,
        }
    }

    /// The deflection y of the flanks [rad] at x [rad].
    #[inline]
    pub(crate) fn outside(&self, x: f64) -> f64 {
        if x > self.half {
            x - self.half
        } else if x < -self.half {
            x + self.half
        } else {
            0.0
        }
    }

    /// The torque τ [N·m] at x [rad] and ẋ [rad/s], of flanks with stiffness k and damping d.
    #[inline]
    pub(crate) fn torque(&self, x: f64, rate: f64, stiffness: f64, damping: f64) -> f64 {
        let y = self.outside(x);
        let damped = damping * rate * y.abs() / (y.abs() + self.depth);
        let torque = stiffness * y + damped;
        if torque * y > 0.0 { torque } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::Backlash;

    #[test]
    fn flanks_push_never_pull_and_meet_without_a_jump() {
        let (gap, stiffness, damping) = (1e-3, 1e3, 2.0);
        let backlash = Backlash::new(gap);
        let mut parting = 0;
        for step in -400..=400 {
            let x = 1e-5 * f64::from(step);
            let y = backlash.outside(x);
            assert_eq!(y == 0.0, x.abs() <= 0.5 * gap);
            for rate in [-2.0, -0.1, 0.0, 0.1, 2.0] {
                let torque = backlash.torque(x, rate, stiffness, damping);
                assert!(torque * y >= 0.0, "{torque} N·m at {x} rad, {rate} rad/s");
                parting += u32::from(y != 0.0 && torque == 0.0);
                if rate == 0.0 {
                    assert_eq!(torque, stiffness * y);
                }
            }
        }
        assert!(parting > 50, "{parting} flanks part");
        let touching = backlash.torque(0.5 * gap + 1e-9, 2.0, stiffness, damping);
        assert!(touching < 1e-3, "{touching} N·m");
    }
}
