//! From continuous poles to discrete ones.

use crate::Scalar;

/// e^(−x) for x ≥ 0, for the design of gains (not for the tick): with y = x/64,
/// e^(−x) = (1 + y + y²/2 + y³/6)^(−64), whose relative error is under x·(y³/24).
pub(super) fn decay<S: Scalar>(x: S) -> S {
    let y = x * S::from_f64(1.0 / 64.0);
    let grown = S::ONE + y * (S::ONE + y * S::HALF * (S::ONE + y * S::from_f64(1.0 / 3.0)));
    let mut power = S::ONE / grown;
    for _ in 0..6 {
        power = power * power;
    }
    power
}

#[cfg(test)]
mod tests {
    use super::decay;

    #[test]
    fn matches_the_exponential_within_its_bound() {
        for i in 0..=100 {
            let x = f64::from(i) * 0.1;
            let exact = libm::exp(-x);
            let bound = x * libm::pow(x / 64.0, 3.0) / 24.0 + 1e-14;
            assert!((decay(x) / exact - 1.0).abs() <= bound, "x = {x}");
        }
    }
}
