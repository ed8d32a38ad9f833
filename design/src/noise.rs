//! Pseudo-random numbers from a seed, the same on every platform.

use core::f64::consts::TAU;
use oorandom::Rand64;

/// A seed for each part of what a seed stands for, unlike its neighbours' (SplitMix64's finaliser).
pub(crate) fn stream(seed: u64, part: u64) -> u64 {
    let mut z = seed ^ part.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A stream of pseudo-random numbers.
///
/// ```
/// use fivebar_design::Noise;
///
/// let mut noise = Noise::new(7);
/// let length = 0.16 + 20e-6 * noise.normal(); // m, with a standard deviation of 20 µm
/// assert!((length - 0.16_f64).abs() < 200e-6);
/// assert_eq!(Noise::new(7).uniform(), Noise::new(7).uniform());
/// ```
#[derive(Clone, Debug)]
pub struct Noise {
    uniform: Rand64,
    spare: Option<f64>,
}

impl Noise {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self {
            uniform: Rand64::new(seed.into()),
            spare: None,
        }
    }

    /// A 32-bit integer; all are equally likely.
    #[inline]
    pub fn integer(&mut self) -> i32 {
        self.uniform.rand_u64() as u32 as i32
    }

    /// Uniform in [0, 1).
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        self.uniform.rand_float()
    }

    /// Normal with mean 0 and standard deviation 1, by the Box–Muller transform.
    #[inline]
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        // 1 − u lies in (0, 1], where the logarithm is finite.
        let radius = (-2.0 * libm::log(1.0 - self.uniform())).sqrt();
        let (sin, cos) = libm::sincos(TAU * self.uniform());
        self.spare = Some(radius * sin);
        radius * cos
    }
}
