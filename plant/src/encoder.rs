//! The encoder of one drive: the side of the drive it sits on, its error and its latency.
//!
//! φ = n θm at the motor, φ = θ at the joint;
//! measured: φ + Σ aₖ sin(hₖ φ + pₖ).
//!
//! n is the gear ratio, θm the motor's angle divided by n, θ the joint's angle. The first
//! harmonic is the eccentricity of the encoder's disc or magnet, the second its tilt or
//! ellipticity, the fourth the mismatch of the sine and cosine channels of a magnetic encoder.

use serde::{Deserialize, Serialize};

/// Most harmonics of one encoder.
pub const MOST_HARMONICS: usize = 16;

/// One harmonic of an encoder's error: `amplitude` · sin(`harmonic` · angle + `phase`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Harmonic {
    /// Periods per turn of the encoder's shaft, from 1.
    pub harmonic: u32,
    /// Amplitude, an angle of the encoder's shaft [rad].
    pub amplitude: f64,
    /// Phase where the shaft's angle is zero [rad].
    #[serde(default)]
    pub phase: f64,
}

/// The error of an encoder over a turn of its shaft, as a sum of harmonics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "Vec<Harmonic>", into = "Vec<Harmonic>")]
pub struct Harmonics {
    terms: [Harmonic; MOST_HARMONICS],
    count: usize,
}

/// More harmonics than an encoder may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("must have at most {MOST_HARMONICS} harmonics, not {0}")]
pub struct TooManyHarmonics(pub usize);

impl Harmonics {
    /// No error.
    pub const NONE: Self = Self {
        terms: [Harmonic {
            harmonic: 0,
            amplitude: 0.0,
            phase: 0.0,
        }; MOST_HARMONICS],
        count: 0,
    };

    /// The sum of these harmonics.
    ///
    /// # Errors
    /// More than [`MOST_HARMONICS`].
    pub fn new(harmonics: &[Harmonic]) -> Result<Self, TooManyHarmonics> {
        let mut terms = Self::NONE.terms;
        let places = terms.get_mut(..harmonics.len());
        places
            .ok_or(TooManyHarmonics(harmonics.len()))?
            .copy_from_slice(harmonics);
        Ok(Self {
            terms,
            count: harmonics.len(),
        })
    }

    /// The harmonics.
    pub fn terms(&self) -> &[Harmonic] {
        &self.terms[..self.count]
    }

    /// Whether the error is zero everywhere.
    pub fn is_zero(&self) -> bool {
        self.terms().iter().all(|term| term.amplitude == 0.0)
    }

    /// The error where the encoder's shaft is at `angle` [rad].
    pub fn at(&self, angle: f64) -> f64 {
        let term = |term: &Harmonic| {
            term.amplitude * libm::sin(f64::from(term.harmonic) * angle + term.phase)
        };
        self.terms().iter().map(term).sum()
    }

    /// Upper bound of the error's change per angle, Σ |h a|. From 1 on, the measured angle may
    /// turn backwards while the shaft turns forwards.
    pub fn steepest(&self) -> f64 {
        let slope = |term: &Harmonic| (f64::from(term.harmonic) * term.amplitude).abs();
        self.terms().iter().map(slope).sum()
    }
}

impl TryFrom<Vec<Harmonic>> for Harmonics {
    type Error = TooManyHarmonics;
    fn try_from(harmonics: Vec<Harmonic>) -> Result<Self, TooManyHarmonics> {
        Self::new(&harmonics)
    }
}

impl From<Harmonics> for Vec<Harmonic> {
    fn from(harmonics: Harmonics) -> Self {
        harmonics.terms().to_vec()
    }
}

/// The shaft that an encoder measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EncoderSide {
    /// The motor's shaft.
    #[default]
    Motor,
    /// The joint's shaft, behind gear and belt.
    Joint,
}

/// What the controller knows of an encoder besides its counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Encoder {
    /// The shaft that it measures.
    pub side: EncoderSide,
    /// Age of its angle when it is sampled [s].
    pub latency: f64,
    /// Its error.
    pub error: Harmonics,
}

/// An encoder as it is: the known one with its mismatch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrueEncoder {
    /// The shaft that it measures.
    pub(crate) side: EncoderSide,
    /// φ per angle of the joint.
    ratio: f64,
    /// The known error and the mismatch; none if both are zero.
    errors: Option<[Harmonics; 2]>,
}

impl TrueEncoder {
    /// An encoder behind a gear ratio, with an error besides the known one.
    pub(crate) fn new(known: &Encoder, gear_ratio: f64, unknown: &Harmonics) -> Self {
        let errors = [known.error, *unknown];
        Self {
            side: known.side,
            ratio: match known.side {
                EncoderSide::Motor => gear_ratio,
                EncoderSide::Joint => 1.0,
            },
            errors: errors.iter().any(|e| !e.is_zero()).then_some(errors),
        }
    }

    /// The measured angle over the gear ratio [rad], where the true one is `angle`.
    #[inline]
    pub(crate) fn measured(&self, angle: f64) -> f64 {
        let Some(errors) = &self.errors else {
            return angle;
        };
        let shaft = self.ratio * angle;
        let [known, unknown] = errors.each_ref().map(|error| error.at(shaft));
        angle + (known + unknown) / self.ratio
    }
}
