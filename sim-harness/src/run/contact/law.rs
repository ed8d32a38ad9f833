//! The laws of restitution: how much of an impact a contact gives back.
//!
//! F = K d^1.5 (1 + D ḋ/v₀) for a penetration d, v₀ being its rate at first touch. The
//! restitution e of slow impacts decides the hysteresis D:
//!
//! | law | D |
//! |---|---|
//! | Lankarani and Nikravesh 1990 | ¾ (1 − e²) |
//! | Hunt and Crossley 1975 | 3/2 (1 − e) |
//! | Flores, Machado, Silva, Martins 2011 | 8 (1 − e)/(5 e) |
//!
//! What two free bodies really give back, e′, is not quite e: it satisfies
//! ln((1 + D)/(1 − D e′)) = D (1 + e′) for any such law.

use crate::input::robot::Restitution;

impl Restitution {
    /// The hysteresis D of contacts that give back a share `e` of the speed, in (0, 1].
    pub fn hysteresis(self, e: f64) -> f64 {
        match self {
            Self::LankaraniNikravesh => 0.75 * (1.0 - e * e),
            Self::HuntCrossley => 1.5 * (1.0 - e),
            Self::Flores => 8.0 * (1.0 - e) / (5.0 * e),
        }
    }
}
