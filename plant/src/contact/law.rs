//! Contact laws with restitution: how much of its speed an impact returns.
//!
//! F = K d^1.5 (1 + D ḋ/v₀) for a penetration d; v₀ is ḋ at first touch. The coefficient of
//! restitution e sets the hysteresis factor D:
//!
//! | law | D |
//! |---|---|
//! | Lankarani and Nikravesh 1990 | ¾ (1 − e²) |
//! | Hunt and Crossley 1975 | 3/2 (1 − e) |
//! | Flores, Machado, Silva, Martins 2011 | 8 (1 − e)/(5 e) |
//!
//! The restitution e′ that two free bodies show differs a little from e. For every such law
//! it satisfies ln((1 + D)/(1 − D e′)) = D (1 + e′).

use super::material::Restitution;

impl Restitution {
    /// The hysteresis factor D for a coefficient of restitution `e` in (0, 1].
    pub fn hysteresis(self, e: f64) -> f64 {
        match self {
            Self::LankaraniNikravesh => 0.75 * (1.0 - e * e),
            Self::HuntCrossley => 1.5 * (1.0 - e),
            Self::Flores => 8.0 * (1.0 - e) / (5.0 * e),
        }
    }
}
