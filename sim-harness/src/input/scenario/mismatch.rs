//! How the plant differs from what the controller believes.

use serde::Deserialize;

/// Differences between the simulated arm and the controller's model of it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Mismatch {
    /// Masses and inertias of the links, as a share more: 0.1 is 10 % more.
    pub link_mass: f64,
    /// Friction of the joints, as a share more.
    pub friction: f64,
    /// Payload at C that the controller does not know of [kg].
    pub payload: f64,
    /// Standard deviation of the current samples [ADC codes].
    pub current_noise: f64,
    /// Error of the current sensors' zero [ADC codes].
    pub current_offset: f64,
}

impl Mismatch {
    /// An arm that is exactly as believed, with perfect current sensors. Counts are still
    /// quantised and commands still take a tick.
    pub const NONE: Self = Self {
        link_mass: 0.0,
        friction: 0.0,
        payload: 0.0,
        current_noise: 0.0,
        current_offset: 0.0,
    };

    /// Whether such an arm can be.
    ///
    /// # Errors
    /// The first figure that makes no sense.
    pub fn check(&self) -> Result<(), UnsoundMismatch> {
        for (name, value, least) in [
            // All of a link's mass gone is no link.
            ("link_mass", self.link_mass, -0.99),
            ("friction", self.friction, -1.0),
            ("payload", self.payload, 0.0),
            ("current_noise", self.current_noise, 0.0),
            ("current_offset", self.current_offset, -2048.0),
        ] {
            if !(value >= least && value.is_finite()) {
                return Err(UnsoundMismatch { name, value, least });
            }
        }
        Ok(())
    }
}

/// A figure of a mismatch that makes no sense.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("must be finite and at least {least}, not {value:?}")]
pub struct UnsoundMismatch {
    /// Which one.
    pub name: &'static str,
    /// What it is.
    pub value: f64,
    /// The least it can be.
    pub least: f64,
}

impl Default for Mismatch {
    /// The declared mismatch, under which every figure of accuracy is stated.
    fn default() -> Self {
        Self {
            link_mass: 0.1,
            friction: 0.3,
            payload: 0.02,
            current_noise: 2.0,
            current_offset: 2.0,
        }
    }
}
