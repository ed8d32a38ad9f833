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

/// e^(AT) of A = [0, 1; −q, −c], by rows, for the design of gains: by its power series over T/64, squared six times.
pub(super) fn swing<S: Scalar>(q: S, c: S, period: S) -> [[S; 2]; 2] {
    type Rows<S> = [[S; 2]; 2];
    let product = |[[a, b], [c, d]]: Rows<S>, [[e, f], [g, h]]: Rows<S>| {
        [
            [a * e + b * g, a * f + b * h],
            [c * e + d * g, c * f + d * h],
        ]
    };
    let h = period * S::from_f64(1.0 / 64.0);
    let step = [[S::ZERO, h], [-q * h, -c * h]];
    let one = [[S::ONE, S::ZERO], [S::ZERO, S::ONE]];
    // 1 + B (1 + B/2 (1 + B/3 (1 + B/4))).
    let mut sum = one;
    for divisor in [4.0, 3.0, 2.0, 1.0] {
        let part = product(step, sum).map(|row| row.map(|x| x * S::from_f64(1.0 / divisor)));
        let [[a, b], [c, d]] = part;
        sum = [[S::ONE + a, b], [c, S::ONE + d]];
    }
    for _ in 0..6 {
        sum = product(sum, sum);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::{decay, swing};

    #[test]
    fn matches_the_exponential_within_its_bound() {
        for i in 0..=100 {
            let x = f64::from(i) * 0.1;
            let exact = libm::exp(-x);
            let bound = x * libm::pow(x / 64.0, 3.0) / 24.0 + 1e-14;
            assert!((decay(x) / exact - 1.0).abs() <= bound, "x = {x}");
        }
    }

    #[test]
    fn a_swing_has_its_closed_form() {
        // Without damping, and with a tenth of the critical one.
        for (rate, ratio) in [(2000.0, 0.0), (9000.0, 0.1), (15_000.0, 0.0)] {
            let period = 1e-4;
            let [[a11, a12], [a21, a22]] = swing(rate * rate, 2.0 * ratio * rate, period);
            let (sigma, turn) = (ratio * rate, rate * libm::sqrt(1.0 - ratio * ratio));
            let (sin, cos) = (libm::sin(turn * period), libm::cos(turn * period));
            let shrunk = libm::exp(-sigma * period);
            let near =
                |a: f64, b: f64, scale: f64| assert!((a - b).abs() < 1e-7 * scale, "{a} {b}");
            near(a11, shrunk * (cos + sigma / turn * sin), 1.0);
            near(a12, shrunk * sin / turn, period);
            near(a21, -shrunk * rate * rate / turn * sin, rate);
            near(a22, shrunk * (cos - sigma / turn * sin), 1.0);
        }
    }
}
