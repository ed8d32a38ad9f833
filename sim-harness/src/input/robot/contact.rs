//! `[contact]` of a robot file: what pins and bearings are made of.

use serde::Deserialize;

/// A law of restitution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Restitution {
    /// For e near 1.
    LankaraniNikravesh,
    /// For e near 1.
    HuntCrossley,
    /// For any e.
    Flores,
}

/// `[contact]` of a robot file: pins and bearings of like material.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Contact {
    /// Young's modulus [Pa].
    pub elastic_modulus: f64,
    /// Poisson's ratio [1].
    pub poisson_ratio: f64,
    /// Radius of the bearings [m].
    pub bearing_radius: f64,
    /// Share of the speed that an impact gives back, 0 … 1 [1].
    pub restitution: f64,
    /// How the contact loses the rest.
    pub law: Restitution,
    /// Coefficient of Coulomb friction [1].
    pub friction: f64,
}

impl Default for Contact {
    /// Steel in steel on pins of 8 mm, lubricated, with the restitution that studies of
    /// such joints take.
    fn default() -> Self {
        Self {
            elastic_modulus: 207e9,
            poisson_ratio: 0.3,
            bearing_radius: 4e-3,
            restitution: 0.9,
            law: Restitution::LankaraniNikravesh,
            friction: 0.05,
        }
    }
}

impl Contact {
    /// The first key whose value makes no sense, and what it must be.
    pub fn unsound(&self) -> Option<(&'static str, f64, &'static str)> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        [
            (
                positive(self.elastic_modulus),
                "elastic_modulus",
                self.elastic_modulus,
                "must be a positive finite number of pascals",
            ),
            (
                (0.0..=0.5).contains(&self.poisson_ratio),
                "poisson_ratio",
                self.poisson_ratio,
                "must be in 0 … 0.5",
            ),
            (
                positive(self.bearing_radius),
                "bearing_radius",
                self.bearing_radius,
                "must be a positive finite number of metres",
            ),
            (
                self.restitution > 0.0 && self.restitution <= 1.0,
                "restitution",
                self.restitution,
                "must be above 0 and at most 1",
            ),
            (
                self.friction >= 0.0 && self.friction.is_finite(),
                "friction",
                self.friction,
                "must be finite and not negative",
            ),
        ]
        .into_iter()
        .find_map(|(sound, key, value, must)| (!sound).then_some((key, value, must)))
    }
}
