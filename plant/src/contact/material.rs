//! `[contact]` of a robot file: material and contact law of pins and bearings.

use serde::Deserialize;

/// A contact law; see [`hysteresis`](Self::hysteresis).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Restitution {
    /// Lankarani and Nikravesh 1990, for e near 1.
    LankaraniNikravesh,
    /// Hunt and Crossley 1975, for e near 1.
    HuntCrossley,
    /// Flores, Machado, Silva, Martins 2011, for any e.
    Flores,
}

/// `[contact]` of a robot file; pins and bearings are of the same material.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Contact {
    /// Young's modulus [Pa].
    pub elastic_modulus: f64,
    /// Poisson's ratio [1].
    pub poisson_ratio: f64,
    /// Radius of the bearings [m].
    pub bearing_radius: f64,
    /// Coefficient of restitution e, 0 … 1 [1].
    pub restitution: f64,
    /// The law of the energy loss.
    pub law: Restitution,
    /// Coefficient of Coulomb friction [1].
    pub friction: f64,
}

impl Default for Contact {
    /// Steel on steel, lubricated, with pins of 8 mm and the coefficient of restitution that
    /// is usual in studies of such joints.
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

/// A value of `[contact]` that is not valid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvalidValue {
    /// Its key.
    pub key: &'static str,
    /// The value.
    pub value: f64,
    /// What it must be, in words.
    pub must: &'static str,
}

impl Contact {
    /// The first key whose value is not valid.
    pub fn first_invalid(&self) -> Option<InvalidValue> {
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
        .find_map(|(is_valid, key, value, must)| {
            (!is_valid).then_some(InvalidValue { key, value, must })
        })
    }
}
