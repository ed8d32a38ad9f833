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
