//! How the plant differs from the controller's model.

use serde::Deserialize;

/// Differences between the simulated arm and the controller's model of it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Mismatch {
    /// Excess of the links' masses and inertias, as a share: 0.1 is 10 % more.
    pub link_mass: f64,
    /// Excess of the joints' friction, as a share.
    pub friction: f64,
    /// Excess of the payload at C [kg].
    pub payload: f64,
    /// Standard deviation of the current samples [ADC codes].
    pub current_noise: f64,
    /// Error of the current sensors' zero [ADC codes].
    pub current_offset: f64,
}

impl Mismatch {
    /// No mismatch, and perfect current sensors. Encoder counts are still quantised, and the
    /// outputs still act one tick later.
    pub const NONE: Self = Self {
        link_mass: 0.0,
        friction: 0.0,
        payload: 0.0,
        current_noise: 0.0,
        current_offset: 0.0,
    };

    /// Checks the values.
    ///
    /// # Errors
    /// The first value that is not valid.
    pub fn check(&self) -> Result<(), MismatchError> {
        for (name, value, least) in [
            // −1 would be a link without mass.
            ("link_mass", self.link_mass, -0.99),
            ("friction", self.friction, -1.0),
            ("payload", self.payload, 0.0),
            ("current_noise", self.current_noise, 0.0),
            ("current_offset", self.current_offset, -2048.0),
        ] {
            if !(value >= least && value.is_finite()) {
                return Err(MismatchError { name, value, least });
            }
        }
        Ok(())
    }
}

/// A value of a mismatch that is not valid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("must be finite and at least {least}, not {value:?}")]
pub struct MismatchError {
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// The least valid value.
    pub least: f64,
}

impl Default for Mismatch {
    /// The declared mismatch. All stated figures of accuracy are under this mismatch.
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
