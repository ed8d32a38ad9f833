//! s(τ) = Σ ck τ^k of 8th degree, τ = t/tf, by nine conditions:
//!
//! s, s′, s″ = 0, 0, 0 at τ = 0 and 1, 0, 0 at τ = 1; s = sc, s′ = vc tf, s″ = s̈c tf² at τc.

use nalgebra::{SMatrix, SVector};

/// A motion along a path in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossingLaw {
    /// tf [s].
    pub time: f64,
    /// c0…c8.
    pub coefficients: [f64; 9],
}

impl CrossingLaw {
    /// The law that has sc, ṡc and s̈c at the share τc of its time; none if τc is 0 or 1.
    pub(super) fn through(time: f64, tau_c: f64, at_c: [f64; 3]) -> Option<Self> {
        let [s_c, rate, acceleration] = at_c;
        let mut rows = SMatrix::<f64, 6, 6>::zeros();
        for k in 3..9_i32 {
            let power = f64::from(k);
            let of = |tau: f64| {
                [
                    tau.powi(k),
                    power * tau.powi(k - 1),
                    power * (power - 1.0) * tau.powi(k - 2),
                ]
            };
            let column = [of(1.0), of(tau_c)].concat();
            rows.set_column(
                k as usize - 3,
                &SVector::<f64, 6>::from_column_slice(&column),
            );
        }
        let (s_dot, s_ddot) = (rate * time, acceleration * time * time);
        let wanted = SVector::from([1.0, 0.0, 0.0, s_c, s_dot, s_ddot]);
        let solved = rows.lu().solve(&wanted)?;
        let mut coefficients = [0.0; 9];
        coefficients[3..].copy_from_slice(solved.as_slice());
        Some(Self { time, coefficients })
    }

    /// s, ṡ [1/s] and s̈ [1/s²] at a share of the time.
    pub fn at(&self, tau: f64) -> [f64; 3] {
        let (mut s, mut rate, mut twice) = (0.0, 0.0, 0.0);
        for coefficient in self.coefficients.iter().rev() {
            twice = twice * tau + rate;
            rate = rate * tau + s;
            s = s * tau + coefficient;
        }
        let time = self.time;
        [s, rate / time, 2.0 * twice / (time * time)]
    }
}
