//! Tail probabilities and quantiles of the normal, Student's and the χ² distribution.

/// A normal variable lies within ± this many deviations with 95 %.
pub(crate) const NORMAL_95: f64 = 1.959_963_984_540_054;

/// The factor of a standard deviation with which an interval holds 95 %: Student's quantile t with
/// P(|T| > t) = 0.05, for a deviation that is itself found from data with this many degrees of
/// freedom; 1.96 for infinitely many.
pub(crate) fn coverage_factor(freedom: f64) -> f64 {
    if !freedom.is_finite() {
        return NORMAL_95;
    }
    let (mut low, mut high) = (1.0, 1e4);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if student_beyond(middle, freedom) > 0.05 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// P(|T| > t) of Student's distribution with ν degrees of freedom: I(ν/(ν + t²); ν/2, 1/2).
pub(crate) fn student_beyond(t: f64, freedom: f64) -> f64 {
    incomplete_beta(freedom / (freedom + t * t), 0.5 * freedom, 0.5)
}

/// P(q/(size s²) > F) for the squared size q of a vector of one or two components whose variance
/// s² is found with ν degrees of freedom. With two components it is (1 + q/(ν s²))^(−ν/2).
pub(crate) fn beyond(q: f64, size: usize, freedom: f64) -> f64 {
    match size {
        2 => libm::exp(-0.5 * freedom * libm::log1p(q / freedom)),
        _ => student_beyond(q.max(0.0).sqrt(), freedom),
    }
}

/// P(X > x) of the χ² distribution with ν degrees of freedom.
pub(crate) fn chi_square_beyond(x: f64, freedom: f64) -> f64 {
    1.0 - incomplete_gamma(0.5 * freedom, 0.5 * x.max(0.0))
}

/// The regularised incomplete gamma function P(a, x): its series below a + 1, a continued fraction
/// beyond.
fn incomplete_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let factor = libm::exp(a * libm::log(x) - x - libm::lgamma(a));
    if x < a + 1.0 {
        let (mut term, mut sum) = (1.0 / a, 1.0 / a);
        for n in 1..2000 {
            term *= x / (a + f64::from(n));
            sum += term;
            if term < 1e-16 * sum {
                break;
            }
        }
        return sum * factor;
    }
    let coefficients = (1..2000).map(|n| {
        let n = f64::from(n);
        (-n * (n - a), x + 2.0 * n + 1.0 - a)
    });
    1.0 - factor / continued_fraction(x + 1.0 - a, coefficients)
}

/// The regularised incomplete beta function I(x; a, b), by its continued fraction on the side where
/// that converges fast.
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return if x <= 0.0 { 0.0 } else { 1.0 };
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(1.0 - x, b, a);
    }
    let factor = libm::exp(
        libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b)
            + a * libm::log(x)
            + b * libm::log1p(-x),
    );
    let coefficients = (1..2000).map(|k| {
        let m = f64::from(k / 2);
        let numerator = if k % 2 == 0 {
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m))
        } else {
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        };
        (numerator, 1.0)
    });
    factor / (a * continued_fraction(1.0, coefficients))
}

/// b0 + a1/(b1 + a2/(b2 + …)) from (a, b), by Lentz's method.
fn continued_fraction(b0: f64, coefficients: impl Iterator<Item = (f64, f64)>) -> f64 {
    const TINY: f64 = 1e-300;
    let whole = |value: f64| if value.abs() < TINY { TINY } else { value };
    let (mut c, mut d) = (whole(b0), 0.0);
    let mut value = c;
    for (a, b) in coefficients {
        d = 1.0 / whole(b + a * d);
        c = whole(b + a / c);
        value *= c * d;
        if (c * d - 1.0).abs() < 1e-15 {
            break;
        }
    }
    value
}

#[cfg(test)]
mod tests {
    use super::{beyond, chi_square_beyond, coverage_factor, student_beyond};

    #[test]
    fn quantiles_are_those_of_tables() {
        // Student's t at 97.5 %, and χ² at 95 % and 2.5 %, as tables of statistics print them.
        for (freedom, t) in [(1.0, 12.706), (2.0, 4.303), (5.0, 2.571), (38.0, 2.024)] {
            assert!((coverage_factor(freedom) - t).abs() < 6e-4, "{freedom}");
        }
        assert!((coverage_factor(f64::INFINITY) - 1.96).abs() < 1e-4);
        for (freedom, x, tail) in [
            (1.0, 3.841, 0.05),
            (10.0, 18.307, 0.05),
            (38.0, 22.878, 0.975),
            (38.0, 56.896, 0.025),
        ] {
            assert!((chi_square_beyond(x, freedom) - tail).abs() < 2e-4, "{x}");
        }
    }

    #[test]
    fn the_tails_of_one_and_two_components_meet_the_normal_ones() {
        assert!((beyond(1.96 * 1.96, 1, 1e7) - 0.05).abs() < 1e-4);
        assert!((beyond(5.991, 2, 1e7) - 0.05).abs() < 1e-4);
        // P(F(2, 4) > 6.944) = 0.05.
        assert!((beyond(2.0 * 6.944, 2, 4.0) - 0.05).abs() < 1e-4);
        assert!((student_beyond(1.0, 1.0) - 0.5).abs() < 1e-12);
    }
}
